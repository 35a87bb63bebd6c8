//! The binary container `.glb`.

use super::fault::Fault;

const HEADER: usize = 12;

/// The JSON and the binary chunk of a `.glb`; any other file is all JSON.
pub(super) fn split(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), Fault> {
    if !bytes.starts_with(b"glTF") {
        return Ok((bytes, None));
    }
    let (version, length) = (word(bytes, 4)?, word(bytes, 8)? as usize);
    if version != 2 {
        return Err(Fault::unsupported(format!("version {version} of binary glTF is")));
    }
    if length > bytes.len() || length < HEADER {
        return Err(Fault::malformed(format!("its header claims {length} bytes and it has {}", bytes.len())));
    }
    let (json, rest) = chunk(&bytes[..length], HEADER, b"JSON")?;
    let binary = if rest + 8 <= length { Some(chunk(&bytes[..length], rest, b"BIN\0")?.0) } else { None };
    Ok((trim(json), binary))
}

/// The contents of the chunk at `start`, and where the next one begins.
fn chunk<'a>(bytes: &'a [u8], start: usize, kind: &[u8; 4]) -> Result<(&'a [u8], usize), Fault> {
    let length = word(bytes, start)? as usize;
    let found = word(bytes, start + 4)?.to_le_bytes();
    let name = String::from_utf8_lossy(kind).trim_end_matches('\0').to_owned();
    if found != *kind {
        return Err(Fault::malformed(format!("there is no {name} chunk at byte {start}")));
    }
    let contents = start + 8;
    let left = bytes.len() - contents;
    if length > left {
        return Err(Fault::malformed(format!("the {name} chunk claims {length} bytes and {left} are left")));
    }
    Ok((&bytes[contents..contents + length], contents + length.next_multiple_of(4)))
}

fn word(bytes: &[u8], at: usize) -> Result<u32, Fault> {
    let word = bytes.get(at..).and_then(|rest| rest.first_chunk::<4>());
    word.map(|word| u32::from_le_bytes(*word)).ok_or_else(|| Fault::malformed("it ends within a chunk's header"))
}

/// Without the padding, which some writers make of zeros.
fn trim(json: &[u8]) -> &[u8] {
    let end = json.iter().rposition(|&byte| byte != 0).map_or(0, |last| last + 1);
    &json[..end]
}
