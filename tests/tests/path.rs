//! `canter path`: random paths keep the limits of every axis; its files, its output, its streams.

/// Here so that the files lie in a folder of their own.
mod path {
    mod limits;
    mod verb;
}
