//! Units as FMI wants them: each unit of the table in powers of kg, m, s and rad, with the display units that go with it.

use std::collections::BTreeMap;

use crate::component::VariableTable;

/// A coherent SI unit: kg^a m^b s^c rad^d.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct BaseUnit {
    pub(super) kg: i32,
    pub(super) m: i32,
    pub(super) s: i32,
    pub(super) rad: i32,
}

/// Units of a table by name: powers (if the name is understood) and display units with their factors.
pub(super) type Units = BTreeMap<&'static str, (Option<BaseUnit>, Vec<(&'static str, f64)>)>;

/// All units that real variables of the table use.
pub(super) fn units(table: &VariableTable) -> Units {
    let mut units = Units::new();
    for row in table.rows() {
        if row.unit.is_empty() {
            continue;
        }
        let (_, shown) = units
            .entry(row.unit)
            .or_insert_with(|| (base_unit(row.unit), Vec::new()));
        if let Some(display) = row.display_unit
            && !shown.contains(&display)
        {
            shown.push(display);
        }
    }
    units
}

/// "kg.m/s2" as powers: factors joined by `.`, after `/` in the denominator, an exponent behind the symbol.
fn base_unit(name: &str) -> Option<BaseUnit> {
    let mut sum = BaseUnit::default();
    for (place, part) in name.split('/').enumerate() {
        let sign = if place == 0 { 1 } else { -1 };
        for factor in part.split('.') {
            let digits = factor
                .find(|c: char| c.is_ascii_digit() || c == '-')
                .filter(|at| *at > 0)
                .unwrap_or(factor.len());
            let (symbol, exponent) = factor.split_at(digits);
            let power = sign
                * if exponent.is_empty() {
                    1
                } else {
                    exponent.parse().ok()?
                };
            let (kg, m, s, rad) = match symbol {
                "1" => (0, 0, 0, 0),
                "rad" => (0, 0, 0, 1),
                "kg" => (1, 0, 0, 0),
                "m" => (0, 1, 0, 0),
                "s" => (0, 0, 1, 0),
                "N" => (1, 1, -2, 0),
                "Pa" => (1, -1, -2, 0),
                "J" => (1, 2, -2, 0),
                "W" => (1, 2, -3, 0),
                _ => return None,
            };
            sum.kg += power * kg;
            sum.m += power * m;
            sum.s += power * s;
            sum.rad += power * rad;
        }
    }
    Some(sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_powers_of_kg_m_and_s() {
        let unit = |kg, m, s| {
            let rad = 0;
            Some(BaseUnit { kg, m, s, rad })
        };
        assert_eq!(base_unit("1"), unit(0, 0, 0));
        assert_eq!(base_unit("m"), unit(0, 1, 0));
        assert_eq!(base_unit("kg/s"), unit(1, 0, -1));
        assert_eq!(base_unit("m/s2"), unit(0, 1, -2));
        assert_eq!(base_unit("kg/m3"), unit(1, -3, 0));
        assert_eq!(base_unit("N.m"), unit(1, 2, -2));
        assert_eq!(base_unit("Pa.s"), unit(1, -1, -1));
        assert_eq!(base_unit("m-1"), unit(0, -1, 0));
        let rad = BaseUnit {
            rad: 1,
            ..BaseUnit::default()
        };
        assert_eq!(base_unit("rad"), Some(rad));
        assert_eq!(base_unit("furlong"), None);
        // The power is a parameter: importers get the name alone.
        assert_eq!(base_unit("Pa.s^n"), None);
    }
}
