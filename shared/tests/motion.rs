//! The promise of `motion`: limits kept, nothing jumps, ends exact; over random moves.

/// Here so that the files lie in a folder of their own.
mod motion {
    mod beta;
    mod from_rest;
    mod limits;
    mod nonsense;
    mod retarget;
    mod sequence;
    mod stop;
    mod watch;
}
