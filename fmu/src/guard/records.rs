//! Structures of the plain C interface, as include/sandgate.h has them.

use std::ffi::c_char;

use super::border::Plain;

/// `sandgate_variable`.
#[derive(Clone, Copy)]
#[repr(C)]
pub(crate) struct CVariable {
    pub(crate) name: *const c_char,
    pub(crate) description: *const c_char,
    pub(crate) unit: *const c_char,
    pub(crate) display_unit: *const c_char,
    pub(crate) display_factor: f64,
    pub(crate) minimum: f64,
    pub(crate) maximum: f64,
    pub(crate) length: u64,
    pub(crate) reference: u32,
    pub(crate) causality: i32,
    pub(crate) variability: i32,
    pub(crate) kind: i32,
    pub(crate) has_start: i32,
    pub(crate) is_element: i32,
    pub(crate) element_of: u32,
    pub(crate) element_index: u32,
}

/// `sandgate_step_report`.
#[derive(Clone, Copy)]
#[repr(C)]
pub(crate) struct CStepReport {
    pub(crate) time: f64,
    pub(crate) smallest_step: f64,
    pub(crate) substeps: u32,
    pub(crate) iterations: u32,
}

/// `sandgate_ledger`.
#[derive(Clone, Copy)]
#[repr(C)]
pub(crate) struct CLedger {
    pub(crate) initial: f64,
    pub(crate) inflow: f64,
    pub(crate) outflow: f64,
    pub(crate) present: f64,
}

// SAFETY: numbers, and pointers that this library only writes.
unsafe impl Plain for CVariable {}
// SAFETY: numbers.
unsafe impl Plain for CStepReport {}
// SAFETY: numbers.
unsafe impl Plain for CLedger {}

#[cfg(test)]
mod tests {
    use std::mem::offset_of;

    use super::*;
    use crate::guard::Callbacks2;

    /// The same numbers stand in tests/c/signatures.hpp.
    #[test]
    fn structures_have_the_layout_of_the_headers() {
        assert_eq!(size_of::<Callbacks2>(), 40);
        assert_eq!(offset_of!(Callbacks2, environment), 32);
        assert_eq!(size_of::<CVariable>(), 96);
        assert_eq!(offset_of!(CVariable, length), 56);
        assert_eq!(offset_of!(CVariable, element_index), 92);
        assert_eq!(size_of::<CStepReport>(), 24);
        assert_eq!(offset_of!(CStepReport, iterations), 20);
        assert_eq!(size_of::<CLedger>(), 32);
    }
}
