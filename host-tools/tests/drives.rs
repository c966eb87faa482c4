//! Nodes with links to drives, against models of the drives, in virtual time: each kind through all that
//! can happen to it.

/// Here so that the files lie in a folder of their own.
mod drives {
    mod enabling;
    mod rig;
    mod trouble;
}
