//! The protocol from outside: golden frames, canter.dbc, the documents, and what cantools, which
//! shares no code with canter, makes of them.
//!
//! `tests/golden/frames.tsv` is the protocol's promise: no test rewrites it. What is generated
//! (canter.dbc and the tables in docs/) is written anew with CANTER_UPDATE_SNAPSHOTS=1.

/// Here so that the files lie in a folder of their own.
mod protocol {
    mod cantools;
    mod documents;
    mod example;
    mod golden;
    mod properties;
}
