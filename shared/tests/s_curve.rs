//! The promise of `motion::s_curve`: limits kept, ends exact, nothing quicker; over random states and
//! limits of every size. The durations of published vectors are held in `vectors`.

/// Here so that the files lie in a folder of their own.
mod s_curve {
    mod any_bits;
    mod edges;
    mod lasting;
    mod optimal;
    mod random;
    mod symmetry;
    mod to_rest;
}
