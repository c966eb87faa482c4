//! The promise of `parameter::store`: whenever the power goes, what is read back is all of the old
//! parameters or all of the new ones; and damage is noticed.

/// Here so that the files lie in a folder of their own.
mod store {
    mod cut;
    mod damage;
    mod power;
    mod round_trip;
    mod versions;
}
