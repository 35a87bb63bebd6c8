//! Fingerprints of contents: SHA-256 in hexadecimal.

use sha2::{Digest, Sha256};

/// Of some bytes.
pub(crate) fn hex(bytes: &[u8]) -> String {
    in_hexadecimal(&Sha256::digest(bytes))
}

fn in_hexadecimal(digest: &[u8]) -> String {
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Of arrays of numbers, each with its length before it, so that no two lists of arrays look alike.
#[cfg(feature = "trace")]
#[derive(Debug, Default)]
pub(crate) struct Content(Sha256);

#[cfg(feature = "trace")]
impl Content {
    pub(crate) fn bytes(&mut self, bytes: &[u8]) {
        self.0.update(bytes);
    }

    /// - `to_bytes`: of one number
    pub(crate) fn array<T: Copy, const N: usize>(&mut self, values: &[T], to_bytes: impl Fn(T) -> [u8; N]) {
        self.0.update((values.len() as u64).to_le_bytes());
        for chunk in values.chunks(1024) {
            let bytes: Vec<u8> = chunk.iter().flat_map(|&value| to_bytes(value)).collect();
            self.0.update(&bytes);
        }
    }

    pub(crate) fn finish(self) -> String {
        in_hexadecimal(&self.0.finalize())
    }
}

#[cfg(all(test, feature = "trace"))]
mod tests {
    use super::*;

    #[test]
    fn bytes_have_the_published_fingerprint() {
        // FIPS 180-4, the example "abc".
        assert_eq!(hex(b"abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    }

    #[test]
    fn moving_a_number_to_the_next_array_changes_it() {
        let of = |arrays: [&[f32]; 2]| {
            let mut content = Content::default();
            arrays.iter().for_each(|array| content.array(array, f32::to_le_bytes));
            content.finish()
        };
        assert_ne!(of([&[1.0, 2.0], &[3.0]]), of([&[1.0], &[2.0, 3.0]]));
        assert_eq!(of([&[1.0], &[2.0]]), of([&[1.0], &[2.0]]));
    }
}
