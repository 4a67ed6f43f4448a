//! What readers make of viewers' messages, those of other programs too: numbers of packed points, of whatever type their fields say,
//! and where a frame lies.

use super::foxglove::{FrameTransform, NumericType, PackedElementField, PointCloud, Pose};

impl PackedElementField {
    /// Its number in a point; none where the point ends before it or the type is not known.
    #[must_use]
    pub fn of_point(&self, point: &[u8]) -> Option<f64> {
        fn bytes<const N: usize>(data: &[u8]) -> Option<[u8; N]> {
            data.first_chunk().copied()
        }
        let data = point.get(self.offset as usize..)?;
        Some(match self.r#type() {
            NumericType::Unknown => return None,
            NumericType::Uint8 => u8::from_le_bytes(bytes(data)?).into(),
            NumericType::Int8 => i8::from_le_bytes(bytes(data)?).into(),
            NumericType::Uint16 => u16::from_le_bytes(bytes(data)?).into(),
            NumericType::Int16 => i16::from_le_bytes(bytes(data)?).into(),
            NumericType::Uint32 => u32::from_le_bytes(bytes(data)?).into(),
            NumericType::Int32 => i32::from_le_bytes(bytes(data)?).into(),
            NumericType::Float32 => f32::from_le_bytes(bytes(data)?).into(),
            NumericType::Float64 => f64::from_le_bytes(bytes(data)?),
        })
    }
}

impl PointCloud {
    /// The points, each as its bytes.
    pub fn points(&self) -> impl ExactSizeIterator<Item = &[u8]> {
        self.data.chunks_exact((self.point_stride as usize).max(1))
    }

    /// The values of a field, one a point: 0 where the cloud does not have it.
    #[must_use]
    pub fn column(&self, name: &str) -> Vec<f32> {
        let field = self.fields.iter().find(|field| field.name == name);
        let value = |point| field.and_then(|field| field.of_point(point));
        self.points()
            .map(|point| value(point).unwrap_or(0.0) as f32)
            .collect()
    }
}

impl FrameTransform {
    /// Where its origin lies in its parent, and how it is turned.
    #[must_use]
    pub fn pose(&self) -> Pose {
        Pose {
            position: self.translation.clone(),
            orientation: self.rotation.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_read_as_the_type_that_they_say() {
        let field = |name: &str, offset: u32, of: NumericType| PackedElementField {
            name: name.to_owned(),
            offset,
            r#type: of as i32,
        };
        let mut data = Vec::new();
        for (x, count, kind) in [(1.5f64, 70_000u32, 7u8), (-2.0, 1, 255)] {
            data.extend(x.to_le_bytes());
            data.extend(count.to_le_bytes());
            data.push(kind);
        }
        let cloud = PointCloud {
            point_stride: 13,
            fields: vec![
                field("x", 0, NumericType::Float64),
                field("count", 8, NumericType::Uint32),
                field("kind", 12, NumericType::Uint8),
                field("signed", 12, NumericType::Int8),
                field("beyond", 12, NumericType::Float32),
                field("unsaid", 0, NumericType::Unknown),
            ],
            data,
            ..PointCloud::default()
        };
        assert_eq!(cloud.column("x"), [1.5, -2.0]);
        assert_eq!(cloud.column("count"), [70_000.0, 1.0]);
        assert_eq!(cloud.column("kind"), [7.0, 255.0]);
        assert_eq!(cloud.column("signed"), [7.0, -1.0]);
        for none in ["beyond", "unsaid", "not there"] {
            assert_eq!(cloud.column(none), [0.0, 0.0], "{none}");
        }
    }
}
