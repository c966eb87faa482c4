//! When the setpoints of a node are on the drives' bus, after their tick: three axes at 1 kHz on a simulated
//! bus, with all that their drives say on it.

/// Here so that the files lie in a folder of their own.
mod setpoints {
    mod rig;
    mod times;
}
