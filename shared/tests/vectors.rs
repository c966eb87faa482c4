//! The profiles in f64 against numbers that other programs computed; see tests/vectors.

/// Here so that the files lie in a folder of their own.
mod vectors {
    mod beta;
    mod beta_general;
    mod csv;
    mod polynomial;
    mod ratios;
    mod s_curve;
    mod trapezoid;
}
