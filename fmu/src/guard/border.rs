//! Pointers to plain data and to text, as C callers hand them over.

use std::ffi::{CStr, c_char};
use std::ptr;

use crate::fault::Fault;

/// Types that hold no invariant: any bytes of the right number are a value.
///
/// # Safety
/// Implement it for such types only.
pub(crate) unsafe trait Plain: Copy {}

macro_rules! plain {
    ($($t:ty),*) => {
        // SAFETY: numbers take any bytes.
        $(unsafe impl Plain for $t {})*
    };
}
plain!(i8, u8, i16, u16, i32, u32, i64, u64, usize, f32, f64);
// SAFETY: a pointer that is only passed on takes any bytes.
unsafe impl Plain for *const c_char {}

/// `const T values[]` of a C caller: NULL, or as many elements as the count beside it says.
#[repr(transparent)]
pub(crate) struct In<T>(*const T);

impl<T: Plain> In<T> {
    /// The elements. NULL is fine for none.
    pub(crate) fn slice(&self, count: usize, what: &str) -> Result<&[T], Fault> {
        if count == 0 {
            return Ok(&[]);
        }
        check(self.0, count, what)?;
        // SAFETY: not NULL, aligned, not larger than an address space (all just checked); the C caller promises
        // `count` elements for the time of the call, and `self` does not outlive the call.
        Ok(unsafe { std::slice::from_raw_parts(self.0, count) })
    }
}

/// `T values[]` or `T* value` of a C caller, to be written: NULL, or room for as many elements as said.
#[repr(transparent)]
pub(crate) struct Out<T>(*mut T);

impl<T: Plain> Out<T> {
    /// Fails if `count` elements could not be written.
    pub(crate) fn check(&self, count: usize, what: &str) -> Result<(), Fault> {
        if count == 0 {
            return Ok(());
        }
        check(self.0, count, what)
    }

    /// Writes all values.
    pub(crate) fn write(&mut self, values: &[T], what: &str) -> Result<(), Fault> {
        self.check(values.len(), what)?;
        if !values.is_empty() {
            // SAFETY: not NULL, aligned (just checked), the C caller promises room for as many elements as it asked
            // for, and `values` is memory of ours.
            unsafe { ptr::copy_nonoverlapping(values.as_ptr(), self.0, values.len()) }
        }
        Ok(())
    }

    /// Writes one value, unless the caller does not want it (NULL).
    pub(crate) fn write_if_wanted(&mut self, value: T) {
        if !self.0.is_null() {
            // SAFETY: not NULL; `write_unaligned` asks for no alignment; the C caller promises room for one element.
            unsafe { self.0.write_unaligned(value) }
        }
    }
}

fn check<T>(pointer: *const T, count: usize, what: &str) -> Result<(), Fault> {
    if pointer.is_null() {
        return Err(Fault::border(format!(
            "{what}: found NULL, expected room for {count} values"
        )));
    }
    let fits = count
        .checked_mul(size_of::<T>())
        .is_some_and(|bytes| isize::try_from(bytes).is_ok());
    if !fits {
        return Err(Fault::border(format!(
            "{what}: found {count} values, expected at most {} of {} bytes each, what memory can hold; look at the count of the call",
            isize::MAX as usize / size_of::<T>().max(1),
            size_of::<T>()
        )));
    }
    if !pointer.is_aligned() {
        return Err(Fault::border(format!(
            "{what}: found {count} values at {pointer:p}, expected an array aligned to {} bytes; look at the types of the call",
            align_of::<T>()
        )));
    }
    Ok(())
}

/// `const char*` of a C caller: NULL, or text that ends with a zero byte.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub(crate) struct Text(*const c_char);

impl Text {
    /// The text, `default` for NULL.
    pub(crate) fn get_or<'a>(&'a self, what: &str, default: &'a str) -> Result<&'a str, Fault> {
        if self.0.is_null() {
            return Ok(default);
        }
        self.get(what)
    }

    /// The text.
    pub(crate) fn get(&self, what: &str) -> Result<&str, Fault> {
        if self.0.is_null() {
            return Err(Fault::border(format!("{what}: found NULL, expected text")));
        }
        // SAFETY: not NULL; the C caller promises text that ends with a zero byte and stays for the time of the call,
        // and `self` does not outlive the call.
        let text = unsafe { CStr::from_ptr(self.0) };
        text.to_str()
            .map_err(|error| Fault::border(format!("{what}: not UTF-8 ({error})")))
    }
}

// SAFETY: as for `In`: an array of texts comes from a C caller, who promises each of them.
unsafe impl Plain for Text {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn null_is_no_array_unless_it_is_empty() {
        let none = In::<f64>(ptr::null());
        assert!(none.slice(0, "x").is_ok_and(<[f64]>::is_empty));
        let said = none.slice(2, "value").expect_err("NULL").to_string();
        assert_eq!(said, "value: found NULL, expected room for 2 values");
        let mut out = Out::<f64>(ptr::null_mut());
        assert!(out.write(&[], "x").is_ok());
        assert!(out.write(&[1.0], "x").is_err());
        out.write_if_wanted(1.0);
        let none = Text(ptr::null());
        assert!(none.get("name").is_err());
        assert!(
            none.get_or("name", "scene")
                .is_ok_and(|name| name == "scene")
        );
        let broken = [0xff_u8, 0];
        let broken = Text(broken.as_ptr().cast());
        let said = broken.get_or("name", "scene");
        assert!(
            said.expect_err("not UTF-8")
                .to_string()
                .contains("name: not UTF-8")
        );
    }

    #[test]
    fn arrays_larger_than_memory_or_not_aligned_are_refused() {
        let values = [1.0, 2.0, 3.0];
        let some = In(values.as_ptr());
        assert!(some.slice(3, "x").is_ok_and(|found| found == values));
        assert!(some.slice(usize::MAX, "x").is_err());
        let odd = In::<f64>(values.as_ptr().cast::<u8>().wrapping_add(1).cast());
        assert!(odd.slice(1, "x").is_err());
    }

    #[test]
    fn text_must_be_utf8() {
        assert_eq!(Text(c"ä".as_ptr()).get("x").expect("UTF-8"), "ä");
        assert!(Text(c"\xff".as_ptr()).get("x").is_err());
    }
}
