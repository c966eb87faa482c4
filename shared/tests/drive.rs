//! The links to drives: the bytes that they send and take, and when.

/// Here so that the files lie in a folder of their own.
mod drive {
    mod bench;
    mod cia402;
    mod link;
    mod mit;
    mod odrive;
    mod parameters;
    mod random;
}
