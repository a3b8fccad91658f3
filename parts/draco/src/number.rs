//! Converts components from Draco's types to those of glTF, as the reference decoder does.

use draco_core::DataType;

/// A component type of glTF.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Target {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Target {
    /// Looks up glTF's code.
    pub fn new(component_type: u32) -> Option<Self> {
        match component_type {
            5120 => Some(Self::I8),
            5121 => Some(Self::U8),
            5122 => Some(Self::I16),
            5123 => Some(Self::U16),
            5125 => Some(Self::U32),
            5126 => Some(Self::F32),
            _ => None,
        }
    }

    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// The value that represents 1 if the component is normalized.
    fn one(self) -> f64 {
        match self {
            Self::I8 => i8::MAX.into(),
            Self::U8 => u8::MAX.into(),
            Self::I16 => i16::MAX.into(),
            Self::U16 => u16::MAX.into(),
            Self::U32 => u32::MAX.into(),
            Self::F32 => 1.0,
        }
    }

    /// Appends a component of another type to `data` and returns it. Integers are saturated.
    pub fn append(self, from: DataType, normalized: bool, bytes: &[u8], data: &mut Vec<u8>) -> f32 {
        let (mut number, one) = read(from, bytes);
        if normalized && from.is_integral() && self == Self::F32 {
            number /= one;
        } else if normalized && !from.is_integral() && self != Self::F32 {
            number = (number * self.one() + 0.5).floor();
        }
        let before = data.len();
        match self {
            Self::I8 => data.extend((number as i8).to_le_bytes()),
            Self::U8 => data.extend((number as u8).to_le_bytes()),
            Self::I16 => data.extend((number as i16).to_le_bytes()),
            Self::U16 => data.extend((number as u16).to_le_bytes()),
            Self::U32 => data.extend((number as u32).to_le_bytes()),
            Self::F32 => data.extend((number as f32).to_le_bytes()),
        }
        // What was written: quantized joints, for example, have a fraction before.
        read(self.data_type(), &data[before..]).0 as f32
    }

    fn data_type(self) -> DataType {
        match self {
            Self::I8 => DataType::Int8,
            Self::U8 => DataType::Uint8,
            Self::I16 => DataType::Int16,
            Self::U16 => DataType::Uint16,
            Self::U32 => DataType::Uint32,
            Self::F32 => DataType::Float32,
        }
    }
}

/// Returns a component, and the value that represents 1 if it is normalized.
fn read(from: DataType, bytes: &[u8]) -> (f64, f64) {
    fn array<const SIZE: usize>(bytes: &[u8]) -> [u8; SIZE] {
        bytes.try_into().unwrap_or([0; SIZE])
    }
    match from {
        DataType::Invalid => (0.0, 1.0),
        DataType::Bool => (u8::from_le_bytes(array(bytes)).into(), 1.0),
        DataType::Int8 => (i8::from_le_bytes(array(bytes)).into(), i8::MAX.into()),
        DataType::Uint8 => (u8::from_le_bytes(array(bytes)).into(), u8::MAX.into()),
        DataType::Int16 => (i16::from_le_bytes(array(bytes)).into(), i16::MAX.into()),
        DataType::Uint16 => (u16::from_le_bytes(array(bytes)).into(), u16::MAX.into()),
        DataType::Int32 => (i32::from_le_bytes(array(bytes)).into(), i32::MAX.into()),
        DataType::Uint32 => (u32::from_le_bytes(array(bytes)).into(), u32::MAX.into()),
        DataType::Int64 => (i64::from_le_bytes(array(bytes)) as f64, i64::MAX as f64),
        DataType::Uint64 => (u64::from_le_bytes(array(bytes)) as f64, u64::MAX as f64),
        DataType::Float32 => (f32::from_le_bytes(array(bytes)).into(), 1.0),
        DataType::Float64 => (f64::from_le_bytes(array(bytes)), 1.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn components_are_converted_like_the_reference_decoder_does() {
        let check = |from: DataType, normalized, bytes: &[u8], component_type, expected: &[u8]| {
            let mut data = Vec::new();
            let target = Target::new(component_type).unwrap();
            let written = target.append(from, normalized, bytes, &mut data);
            assert_eq!(data, expected, "{from:?} {bytes:?} to {component_type}");
            assert_eq!(written, read(target.data_type(), expected).0 as f32);
        };
        check(DataType::Float32, false, &1.25_f32.to_le_bytes(), 5126, &1.25_f32.to_le_bytes());
        check(DataType::Uint8, true, &[255], 5126, &1.0_f32.to_le_bytes());
        check(DataType::Uint8, false, &[255], 5126, &255.0_f32.to_le_bytes());
        check(DataType::Float32, false, &29.003_f32.to_le_bytes(), 5123, &[29, 0]);
        check(DataType::Float32, true, &0.5_f32.to_le_bytes(), 5121, &[128]);
        check(DataType::Uint8, true, &[7], 5123, &[7, 0]);
        check(DataType::Int32, false, &(-5_i32).to_le_bytes(), 5120, &[251]);
        check(DataType::Int32, false, &(-5_i32).to_le_bytes(), 5123, &[0, 0]);
        check(DataType::Uint64, false, &70_000_u64.to_le_bytes(), 5125, &70_000_u32.to_le_bytes());
    }
}
