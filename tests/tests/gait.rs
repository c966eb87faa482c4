//! Gaits: the planner under random orders, and `canter gait` as people call it.

/// Here so that the files lie in a folder of their own.
mod gait {
    mod continuity;
}
