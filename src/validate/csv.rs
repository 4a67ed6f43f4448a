//! Reference tables: comma-separated numbers with a line of column names; `#` begins a comment line.

/// Rows of the named columns, in the order in which they are named.
///
/// # Errors
/// A column that is not there, or an entry that is no number, with its line.
pub fn columns<const N: usize>(text: &str, names: [&str; N]) -> Result<Vec<[f64; N]>, String> {
    let mut lines = text.lines().enumerate();
    let is_data = |(_, line): &(usize, &str)| !line.starts_with('#') && !line.trim().is_empty();
    let (_, head) = lines.find(is_data).ok_or("a table without a line")?;
    let head: Vec<&str> = head.split(',').map(str::trim).collect();
    let mut places = [0; N];
    for (place, name) in places.iter_mut().zip(names) {
        let found = head.iter().position(|h| *h == name);
        *place = found.ok_or_else(|| format!("no column {name}, there are {}", head.join(", ")))?;
    }
    let mut rows = Vec::new();
    for (number, line) in lines.filter(is_data) {
        let cells: Vec<&str> = line.split(',').map(str::trim).collect();
        let mut row = [0.0; N];
        for (value, &place) in row.iter_mut().zip(&places) {
            let cell = cells.get(place).copied().unwrap_or_default();
            let parsed = cell.parse();
            *value = parsed.map_err(|_| format!("line {}: {cell:?} is no number", number + 1))?;
        }
        rows.push(row);
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::columns;

    #[test]
    fn columns_are_found_by_name_and_bad_ones_refused() {
        let text = "# about\nx, y,z\n1,2,3\n\n4,5e-1,6\n";
        assert_eq!(columns(text, ["z", "y"]), Ok(vec![[3.0, 2.0], [6.0, 0.5]]));
        assert!(columns(text, ["w"]).unwrap_err().contains("x, y, z"));
        assert!(columns("x\nfour\n", ["x"]).unwrap_err().contains("line 2"));
        assert!(columns("# nothing\n", ["x"]).is_err());
    }
}
