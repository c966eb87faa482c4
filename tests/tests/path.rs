//! Paths: random ones keep the limits of every axis.

/// Here so that the files lie in a folder of their own.
mod path {
    mod limits;
}
