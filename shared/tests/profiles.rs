//! What every profile in f64 promises, over random moves: exact ends, limits, derivatives that agree,
//! and the same move mirrored, scaled or run backwards; and no panic, whatever the numbers.

/// Here so that the files lie in a folder of their own.
mod profiles {
    mod beta;
    mod bezier;
    mod check;
    mod hostile;
    mod polynomial;
    mod slower;
    mod sync;
    mod to_rest;
    mod trapezoid;
}
