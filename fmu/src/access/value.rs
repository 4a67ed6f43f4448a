//! Types that values have at the border.

use sandgate::component::ValueKind;

/// A type that values of one kind of variable have at the border.
pub(crate) trait Value: Copy {
    /// Variables that take it.
    const KIND: ValueKind;
    /// Into the component; refuses what the kind does not hold.
    fn enter(self) -> Result<f64, String>;
    /// Out of the component.
    fn leave(value: f64) -> Result<Self, String>;
}

impl Value for f64 {
    const KIND: ValueKind = ValueKind::Real;

    fn enter(self) -> Result<f64, String> {
        Ok(self)
    }

    fn leave(value: f64) -> Result<Self, String> {
        Ok(value)
    }
}

/// FMI 2's Integer and Enumeration.
impl Value for i32 {
    const KIND: ValueKind = ValueKind::Integer;

    fn enter(self) -> Result<f64, String> {
        Ok(f64::from(self))
    }

    fn leave(value: f64) -> Result<Self, String> {
        let inside = (f64::from(Self::MIN)..=f64::from(Self::MAX)).contains(&value);
        if inside {
            // In range and whole: nothing is lost.
            Ok(value as Self)
        } else {
            Err(format!(
                "{value} does not fit FMI 2's Integer; FMI 3 has Int64"
            ))
        }
    }
}

/// FMI 3's Int64 and Enumeration.
impl Value for i64 {
    const KIND: ValueKind = ValueKind::Integer;

    fn enter(self) -> Result<f64, String> {
        let value = self as f64;
        if self.unsigned_abs() <= 1 << 53 {
            Ok(value)
        } else {
            Err(format!("{self} is beyond 2^53"))
        }
    }

    fn leave(value: f64) -> Result<Self, String> {
        // Counts stay far below 2^53: whole and in range.
        Ok(value as Self)
    }
}

/// A Boolean as the number it is in C: `int` in FMI 2, `bool` (one byte) in FMI 3.
#[derive(Clone, Copy)]
pub(crate) struct Flag(bool);

impl Flag {
    /// 0 or 1.
    pub(crate) fn from_number(number: i64) -> Result<Self, String> {
        match number {
            0 => Ok(Self(false)),
            1 => Ok(Self(true)),
            other => Err(format!("found {other}, a Boolean is 0 or 1")),
        }
    }

    /// 0 or 1.
    pub(crate) fn number(self) -> u8 {
        u8::from(self.0)
    }
}

impl Value for Flag {
    const KIND: ValueKind = ValueKind::Boolean;

    fn enter(self) -> Result<f64, String> {
        Ok(f64::from(self.number()))
    }

    fn leave(value: f64) -> Result<Self, String> {
        Ok(Self(value != 0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_that_do_not_fit_are_refused() {
        assert_eq!(<i32 as Value>::leave(-3.0), Ok(-3));
        assert!(<i32 as Value>::leave(3e9).is_err());
        assert_eq!(<i64 as Value>::leave(3e9), Ok(3_000_000_000));
        assert_eq!(<i64 as Value>::enter(7), Ok(7.0));
        assert!(<i64 as Value>::enter(i64::MAX).is_err());
        assert!(Flag::from_number(2).is_err());
        assert_eq!(Flag::from_number(1).map(Flag::number), Ok(1));
    }
}
