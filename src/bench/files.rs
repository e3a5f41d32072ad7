//! Rays and hits in files: little-endian records without a header, `SET.rays` and `SET.hits` in the same order.

use crate::error::{Error, Result};
use crate::input;
use crate::output;
use bytemuck::{Pod, Zeroable};
use std::path::Path;

/// A ray of a `.rays` file: points `origin + t direction` for t in (`t_min`, `t_max`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct RayRecord {
    /// Where it starts.
    pub origin: [f32; 3],
    /// Where its interval begins; 0 in all sets.
    pub t_min: f32,
    /// Where it goes; any length.
    pub direction: [f32; 3],
    /// Where its interval ends, in lengths of `direction`; may be infinite.
    pub t_max: f32,
}

/// A hit of a `.hits` file. Any-hit queries say only whether there is one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct HitRecord {
    /// Distance in lengths of the ray's direction; infinite of a miss.
    pub t: f32,
    /// Weight of the triangle's second corner.
    pub u: f32,
    /// Weight of the triangle's third corner.
    pub v: f32,
    /// Number of the triangle, counted from 0.
    pub triangle: u32,
}

impl HitRecord {
    /// Stands for no hit.
    pub const MISS: Self = Self { t: f32::INFINITY, u: 0.0, v: 0.0, triangle: u32::MAX };
    /// Stands for any hit, where it is not asked which.
    pub const SOME: Self = Self { t: 0.0, u: 0.0, v: 0.0, triangle: 0 };

    /// Whether something was hit.
    pub fn is_some(&self) -> bool {
        self.triangle != u32::MAX
    }
}

/// Most rays of a set: a kernel numbers them in 32 bits.
pub const MAX_RAYS: usize = u32::MAX as usize - 8;

/// Reads a `.rays` file.
///
/// # Errors
/// [`Error::Io`] where the file cannot be read; [`Error::Output`] with the number of the ray where one does not begin at
/// `t_min` 0, is not finite in its origin or its direction, or has no number as `t_max`, and where the file does not hold
/// whole rays.
pub fn read_rays(path: &Path) -> Result<Vec<RayRecord>> {
    let rays: Vec<RayRecord> = read(path)?;
    let fault = |reason: String| Error::Output { file: path.to_owned(), reason };
    if rays.len() > MAX_RAYS {
        return Err(fault(format!("found {} rays, expected at most {MAX_RAYS}", rays.len())));
    }
    for (i, ray) in rays.iter().enumerate() {
        if ray.t_min != 0.0 {
            return Err(fault(format!("ray {i}: found tmin {}, expected 0: other starts are not traced", ray.t_min)));
        }
        if !ray.origin.iter().chain(&ray.direction).all(|x| x.is_finite()) || ray.t_max.is_nan() {
            return Err(fault(format!("ray {i}: found {ray:?}, expected finite numbers, and infinity in tmax alone")));
        }
    }
    Ok(rays)
}

/// Reads a `.hits` file.
///
/// # Errors
/// [`Error::Io`] where the file cannot be read, [`Error::Output`] where it does not hold whole hits.
pub fn read_hits(path: &Path) -> Result<Vec<HitRecord>> {
    read(path)
}

/// Writes a `.rays` file; it is there whole or not at all.
///
/// # Errors
/// As [`output::write_bytes`].
pub fn write_rays(path: &Path, rays: &[RayRecord]) -> Result<()> {
    write(path, rays)
}

/// Writes a `.hits` file; it is there whole or not at all.
///
/// # Errors
/// As [`output::write_bytes`].
pub fn write_hits(path: &Path, hits: &[HitRecord]) -> Result<()> {
    write(path, hits)
}

fn read<T: Pod>(path: &Path) -> Result<Vec<T>> {
    let mut bytes =
        input::regular(path).map_err(|source| Error::Io { file: path.to_owned(), action: "read", source })?;
    if !bytes.len().is_multiple_of(size_of::<T>()) {
        let reason = format!("found {} bytes, expected a multiple of {}", bytes.len(), size_of::<T>());
        return Err(Error::Output { file: path.to_owned(), reason });
    }
    turn_words(&mut bytes);
    Ok(bytemuck::pod_collect_to_vec(&bytes))
}

fn write<T: Pod>(path: &Path, records: &[T]) -> Result<()> {
    if cfg!(target_endian = "little") {
        return output::write_bytes(path, bytemuck::cast_slice(records));
    }
    let mut bytes = bytemuck::cast_slice(records).to_vec();
    turn_words(&mut bytes);
    output::write_bytes(path, &bytes)
}

/// From the file's order of bytes to that of the machine, and back.
fn turn_words(bytes: &mut [u8]) {
    if cfg!(target_endian = "big") {
        bytes.as_chunks_mut::<4>().0.iter_mut().for_each(|word| word.reverse());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn ray(i: f32) -> RayRecord {
        RayRecord { origin: [i, 1.0, -2.0], t_min: 0.0, direction: [0.5, i, 3.0], t_max: f32::INFINITY }
    }

    #[test]
    fn files_have_the_documented_layout_and_come_back() {
        let folder = tempfile::tempdir().unwrap();
        let (rays, hits) = (folder.path().join("a.rays"), folder.path().join("a.hits"));
        let written = [ray(7.0), ray(8.0), ray(-9.5)];
        write_rays(&rays, &written).unwrap();
        let bytes = fs::read(&rays).unwrap();
        let words: Vec<f32> = bytes.as_chunks().0.iter().map(|&word| f32::from_le_bytes(word)).collect();
        assert_eq!(words[..8], [7.0, 1.0, -2.0, 0.0, 0.5, 7.0, 3.0, f32::INFINITY]);
        assert_eq!(words.len(), 24);
        assert_eq!(read_rays(&rays).unwrap(), written);

        let written = [HitRecord { t: 1.5, u: 0.25, v: 0.5, triangle: 77 }, HitRecord::MISS, HitRecord::SOME];
        write_hits(&hits, &written).unwrap();
        assert_eq!(read_hits(&hits).unwrap(), written);
        let bytes = fs::read(&hits).unwrap();
        assert_eq!(bytes[12..16], 77u32.to_le_bytes());
        assert_eq!(bytes[16..20], f32::INFINITY.to_le_bytes());
        assert_eq!(bytes[20..32], [0, 0, 0, 0, 0, 0, 0, 0, 255, 255, 255, 255]);
        assert_eq!(bytes[32..], [0; 16]);
    }

    #[test]
    fn files_at_fault_are_named_with_the_ray() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.rays");
        let fails = |rays: &[RayRecord], part: &str| {
            write_rays(&path, rays).unwrap();
            let text = read_rays(&path).unwrap_err().to_string();
            assert!(text.contains("a.rays: ") && text.contains(part), "{text}");
        };
        fails(&[ray(1.0), RayRecord { t_min: 0.001, ..ray(2.0) }], "ray 1: found tmin 0.001, expected 0");
        fails(&[RayRecord { origin: [f32::NAN; 3], ..ray(2.0) }], "ray 0: ");
        fails(&[RayRecord { direction: [f32::INFINITY; 3], ..ray(2.0) }], "ray 0: ");
        fails(&[RayRecord { t_max: f32::NAN, ..ray(2.0) }], "ray 0: ");
        fs::write(&path, [0; 40]).unwrap();
        assert!(read_rays(&path).unwrap_err().to_string().contains("found 40 bytes, expected a multiple of 32"));
        assert!(read_rays(&folder.path().join("none.rays")).unwrap_err().to_string().contains("cannot read"));
    }
}
