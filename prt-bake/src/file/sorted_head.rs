//! OpenEXR images whose attributes stand in the order of their names.
//!
//! The crate `exr` keeps attributes of our own in an order that changes from run to run; sorted, the same bake is the same bytes.

use std::io::{self, Seek, SeekFrom, Write};

/// Magic number and version.
const BEGINNING: usize = 8;

/// Passes an image on, with its attributes sorted. The head must be written first, and from its beginning to its end.
#[derive(Debug)]
pub(super) struct SortedHead<W> {
    inner: W,
    /// What of the head was written; `None` once all of it was passed on.
    head: Option<Vec<u8>>,
}

impl<W: Write> SortedHead<W> {
    pub(super) fn new(inner: W) -> Self {
        Self { inner, head: Some(Vec::new()) }
    }

    /// Passes on what is held back.
    pub(super) fn finish(mut self) -> io::Result<()> {
        let rest = self.head.take().unwrap_or_default();
        self.inner.write_all(&rest)?;
        self.inner.flush()
    }
}

impl<W: Write> Write for SortedHead<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let Some(head) = &mut self.head else { return self.inner.write(bytes) };
        head.extend_from_slice(bytes);
        if let Some((attributes, end)) = attributes(head) {
            let mut sorted = attributes.clone();
            sorted.sort_unstable();
            let sorted = [&head[..BEGINNING], &sorted.concat(), &head[end..]].concat();
            self.head = None;
            self.inner.write_all(&sorted)?;
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

impl<W: Seek> Seek for SortedHead<W> {
    fn seek(&mut self, position: SeekFrom) -> io::Result<u64> {
        match (&self.head, position) {
            (None, _) => self.inner.seek(position),
            (Some(head), SeekFrom::Current(0)) => Ok(head.len() as u64),
            (Some(_), _) => Err(io::Error::other("the head of an image is not written in one go")),
        }
    }
}

/// The attributes of the first part, each as its bytes, and where the zero begins that ends them; `None` if the head is not complete.
fn attributes(head: &[u8]) -> Option<(Vec<&[u8]>, usize)> {
    let (mut attributes, mut start) = (Vec::new(), BEGINNING);
    loop {
        let rest = head.get(start..)?;
        if *rest.first()? == 0 {
            return Some((attributes, start));
        }
        let mut texts = rest.splitn(3, |&byte| byte == 0);
        let (name, kind, value) = (texts.next()?, texts.next()?, texts.next()?);
        let size = u32::from_le_bytes(*value.first_chunk()?) as usize;
        let length = name.len() + 1 + kind.len() + 1 + 4 + size;
        attributes.push(rest.get(..length)?);
        start += length;
    }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "tests")]

    use super::*;

    /// An image without pixels.
    fn image(attributes: &[&[u8]]) -> Vec<u8> {
        [b"magic..v".as_slice(), &attributes.concat(), b"\0chunks"].concat()
    }

    #[test]
    fn attributes_are_sorted_however_they_are_written() {
        let [a, b, c] = [b"a\0string\0\x02\0\0\0\0\0".as_slice(), b"b\0int\0\x04\0\0\0abcd", b"c\0none\0\0\0\0\0"];
        let expected = image(&[a, b, c]);
        for given in [[a, b, c], [b, a, c], [c, b, a]] {
            let given = image(&given);
            for piece in 1..=given.len() {
                let mut written = io::Cursor::new(Vec::new());
                let mut sorted = SortedHead::new(&mut written);
                for (number, bytes) in given.chunks(piece).enumerate() {
                    assert_eq!(sorted.stream_position().unwrap(), (number * piece) as u64);
                    sorted.write_all(bytes).unwrap();
                }
                sorted.finish().unwrap();
                assert_eq!(written.into_inner(), expected, "pieces of {piece}");
            }
        }
    }

    #[test]
    fn what_is_no_whole_head_is_passed_on_as_it_is() {
        let mut written = io::Cursor::new(Vec::new());
        let mut sorted = SortedHead::new(&mut written);
        sorted.write_all(b"magic..vname\0type\0").unwrap();
        sorted.seek(SeekFrom::Start(3)).unwrap_err();
        sorted.finish().unwrap();
        assert_eq!(written.into_inner(), b"magic..vname\0type\0");
    }
}
