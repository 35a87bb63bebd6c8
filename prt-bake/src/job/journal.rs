//! What a bake has done, block by block: in memory, or in a file that survives the program.
//!
//! The file is a magic number and then records, each with its pass, its block, its length and a checksum, appended as blocks are
//! finished. A program that is killed leaves at worst one torn record at the end, which is cut off when the journal is opened again.

use std::collections::HashMap;
use std::fs::{File, TryLockError};
use std::io::{self, BufReader, Read, Seek, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use crate::Error;
use crate::atomic::sync_folder;

/// First bytes of a journal.
const MAGIC: &[u8; 8] = b"prtjob1\n";
/// Pass, block, length and checksum of a record.
const HEAD: usize = 4 + 4 + 8 + 4;
/// Longest time for which a power failure can lose what was done. A killed program loses only blocks that were not finished.
const SYNC_INTERVAL: Duration = Duration::from_secs(20);

/// Whether a file begins as a journal, or the file of a part, does.
#[must_use]
pub fn is_journal(path: &Path) -> bool {
    let mut magic = [0; MAGIC.len()];
    File::open(path).and_then(|mut file| file.read_exact(&mut magic)).is_ok() && magic == *MAGIC
}

/// Where the payload of each record begins, and its length.
type Places = HashMap<Key, (u64, usize)>;

/// Which record: a pass and a block of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct Key {
    pub(crate) pass: u32,
    pub(crate) block: u32,
}

/// Blocks that are done, by pass and number. Blocks are appended and read from many threads.
#[derive(Debug)]
pub(crate) struct Journal(Backing);

#[derive(Debug)]
enum Backing {
    Memory(Mutex<HashMap<Key, Arc<[u8]>>>),
    File(JournalFile),
}

#[derive(Debug)]
struct JournalFile {
    path: PathBuf,
    file: File,
    state: Mutex<State>,
}

#[derive(Debug)]
struct State {
    places: Places,
    /// Where the next record goes.
    end: u64,
    synced: Instant,
}

impl Journal {
    /// A journal that is gone with the program.
    pub(crate) fn in_memory() -> Self {
        Self(Backing::Memory(Mutex::default()))
    }

    /// A new journal in a file, in place of an older one.
    ///
    /// # Errors
    /// If the file cannot be written, or another program is writing it.
    pub(crate) fn create(path: &Path) -> Result<Self, Error> {
        let start = || {
            let file = open_locked(path)?;
            begin(&file)?;
            sync_folder(path);
            Ok(file)
        };
        let file = start().map_err(|cause| Error::Io { action: "write", path: path.to_owned(), cause })?;
        Ok(Self::of_file(path, file, HashMap::new(), MAGIC.len() as u64))
    }

    /// Opens a journal to go on with it. What is not whole at its end is cut off.
    ///
    /// # Errors
    /// If the file cannot be read or written, is not a journal, or another program is writing it.
    pub(crate) fn resume(path: &Path) -> Result<Self, Error> {
        let fail = |cause| Error::Io { action: "resume", path: path.to_owned(), cause };
        let file = open_locked(path).map_err(fail)?;
        if file.metadata().map_err(fail)?.len() < MAGIC.len() as u64 {
            // Killed before anything was written.
            begin(&file).map_err(fail)?;
        }
        let (places, end) = scan(&file, path)?;
        file.set_len(end).map_err(fail)?;
        Ok(Self::of_file(path, file, places, end))
    }

    /// Opens a journal to see what is in it, also while a bake is writing it.
    ///
    /// # Errors
    /// If the file cannot be read, or is not a journal.
    pub(crate) fn inspect(path: &Path) -> Result<Self, Error> {
        let file = File::open(path).map_err(|cause| Error::Io { action: "read", path: path.to_owned(), cause })?;
        let (places, end) = scan(&file, path)?;
        Ok(Self::of_file(path, file, places, end))
    }

    /// Opens a journal to read it. It must be whole.
    ///
    /// # Errors
    /// If the file cannot be read, or is not a journal.
    pub(crate) fn open(path: &Path) -> Result<Self, Error> {
        let fail = |cause| Error::Io { action: "read", path: path.to_owned(), cause };
        let file = File::open(path).map_err(fail)?;
        let (places, end) = scan(&file, path)?;
        match file.metadata().map_err(fail)?.len() - end {
            0 => Ok(Self::of_file(path, file, places, end)),
            rest => Err(damaged(path, format!("its last {rest} bytes are not whole"))),
        }
    }

    fn of_file(path: &Path, file: File, places: Places, end: u64) -> Self {
        let state = Mutex::new(State { places, end, synced: Instant::now() });
        Self(Backing::File(JournalFile { path: path.to_owned(), file, state }))
    }

    pub(crate) fn contains(&self, key: Key) -> bool {
        match &self.0 {
            Backing::Memory(records) => lock(records).contains_key(&key),
            Backing::File(journal) => lock(&journal.state).places.contains_key(&key),
        }
    }

    /// The keys of all records, sorted.
    pub(crate) fn keys(&self) -> Vec<Key> {
        let mut keys: Vec<Key> = match &self.0 {
            Backing::Memory(records) => lock(records).keys().copied().collect(),
            Backing::File(journal) => lock(&journal.state).places.keys().copied().collect(),
        };
        keys.sort_unstable();
        keys
    }

    /// Whether anything of a bake is in it.
    pub(crate) fn has_blocks(&self) -> bool {
        self.keys().into_iter().any(Key::is_of_block)
    }

    /// Adds a record. What was there under this key before is superseded.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub(crate) fn append(&self, key: Key, payload: &[u8]) -> Result<(), Error> {
        match &self.0 {
            Backing::Memory(records) => {
                lock(records).insert(key, payload.into());
                Ok(())
            }
            Backing::File(journal) => journal.append(key, payload).map_err(|cause| Error::Io {
                action: "write",
                path: journal.path.clone(),
                cause,
            }),
        }
    }

    /// Reads a record into `payload`, which is overwritten.
    ///
    /// # Errors
    /// If the file cannot be read, or has no such record.
    pub(crate) fn read(&self, key: Key, payload: &mut Vec<u8>) -> Result<(), Error> {
        payload.clear();
        match &self.0 {
            Backing::Memory(records) => {
                let record = lock(records).get(&key).cloned();
                payload.extend_from_slice(&record.ok_or_else(|| self.missing(key))?);
                Ok(())
            }
            Backing::File(journal) => {
                let place = lock(&journal.state).places.get(&key).copied();
                let (start, length) = place.ok_or_else(|| self.missing(key))?;
                payload.resize(length, 0);
                let read = read_at(&journal.file, payload, start);
                read.map_err(|cause| Error::Io { action: "read", path: journal.path.clone(), cause })
            }
        }
    }

    /// The journal is not what its header says; names the file.
    pub(crate) fn malformed(&self, reason: String) -> Error {
        damaged(&self.path(), reason)
    }

    fn missing(&self, key: Key) -> Error {
        self.malformed(format!("block {} of pass {} is missing", key.block, key.pass))
    }

    fn path(&self) -> PathBuf {
        match &self.0 {
            Backing::Memory(_) => PathBuf::from("a journal in memory"),
            Backing::File(journal) => journal.path.clone(),
        }
    }

    /// Makes sure that all records are on the disk.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub(crate) fn sync(&self) -> Result<(), Error> {
        match &self.0 {
            Backing::Memory(_) => Ok(()),
            Backing::File(journal) => {
                let synced = journal.file.sync_data();
                synced.map_err(|cause| Error::Io { action: "write", path: journal.path.clone(), cause })
            }
        }
    }
}

impl JournalFile {
    /// The record goes out in one write, so that no two threads mix and a torn record can only be the last one.
    fn append(&self, key: Key, payload: &[u8]) -> io::Result<()> {
        let mut record = Vec::with_capacity(HEAD + payload.len());
        record.extend_from_slice(&key.pass.to_le_bytes());
        record.extend_from_slice(&key.block.to_le_bytes());
        record.extend_from_slice(&(payload.len() as u64).to_le_bytes());
        record.extend_from_slice(&checksum(key, payload).to_le_bytes());
        record.extend_from_slice(payload);
        let mut state = lock(&self.state);
        let start = state.end;
        write_at(&self.file, &record, start)?;
        state.end = start + record.len() as u64;
        state.places.insert(key, (start + HEAD as u64, payload.len()));
        if state.synced.elapsed() > SYNC_INTERVAL {
            state.synced = Instant::now();
            drop(state);
            self.file.sync_data()?;
        }
        Ok(())
    }
}

/// A thread that panicked while it held the lock left whole records behind.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn open_locked(path: &Path) -> io::Result<File> {
    let is_busy = || io::Error::new(io::ErrorKind::ResourceBusy, "another bake is writing it");
    let file = File::options().read(true).write(true).create(true).truncate(false).open(path)?;
    match file.try_lock() {
        // Who held the lock may have removed or renamed the file before he let go of it.
        Ok(()) if !is_still_at(&file, path) => Err(is_busy()),
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(is_busy()),
        // Some network file systems cannot lock; then nobody watches over two bakes of one name.
        Err(TryLockError::Error(error)) if error.kind() == io::ErrorKind::Unsupported => Ok(file),
        Err(TryLockError::Error(error)) => Err(error),
    }
}

#[cfg(unix)]
fn is_still_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let identity = |metadata: std::fs::Metadata| (metadata.dev(), metadata.ino());
    let [open, named] = [file.metadata(), std::fs::metadata(path)].map(|metadata| metadata.map(identity).ok());
    open.is_some() && open == named
}

#[cfg(not(unix))]
fn is_still_at(_file: &File, path: &Path) -> bool {
    path.exists()
}

/// Empties a journal.
fn begin(mut file: &File) -> io::Result<()> {
    file.set_len(0)?;
    file.rewind()?;
    file.write_all(MAGIC)
}

fn damaged(path: &Path, reason: String) -> Error {
    Error::Malformed { path: path.to_owned(), format: "bake journal", reason }
}

fn checksum(key: Key, payload: &[u8]) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    hasher.update(&key.pass.to_le_bytes());
    hasher.update(&key.block.to_le_bytes());
    hasher.update(payload);
    hasher.finalize()
}

/// Finds the whole records, and where the last of them ends. One that is damaged is left out; what comes after it counts.
fn scan(file: &File, path: &Path) -> Result<(Places, u64), Error> {
    let fail = |cause| Error::Io { action: "read", path: path.to_owned(), cause };
    let size = file.metadata().map_err(fail)?.len();
    let mut file = file;
    file.rewind().map_err(fail)?;
    let mut input = BufReader::with_capacity(1 << 16, file);
    let mut magic = [0; MAGIC.len()];
    let is_journal = input.read_exact(&mut magic).is_ok() && magic == *MAGIC;
    if !is_journal {
        return Err(damaged(path, "it does not begin as one".to_owned()));
    }
    let (mut places, mut end, mut payload) = (HashMap::new(), MAGIC.len() as u64, Vec::new());
    let mut start = end;
    while let Some((key, is_whole)) = next_record(&mut input, size - start, &mut payload).map_err(fail)? {
        let next = start + (HEAD + payload.len()) as u64;
        if is_whole {
            places.insert(key, (start + HEAD as u64, payload.len()));
            end = next;
        }
        start = next;
    }
    Ok((places, end))
}

/// Reads a record, and whether it is as it was written; `None` at the end, or if its length cannot be right. A claimed length counts only
/// if the file has that many bytes.
fn next_record(input: &mut impl Read, rest: u64, payload: &mut Vec<u8>) -> io::Result<Option<(Key, bool)>> {
    if rest < HEAD as u64 {
        return Ok(None);
    }
    let mut head = [0; HEAD];
    input.read_exact(&mut head)?;
    let word = |start: usize| u32::from_le_bytes([head[start], head[start + 1], head[start + 2], head[start + 3]]);
    let key = Key { pass: word(0), block: word(4) };
    let length = u64::from(word(8)) | u64::from(word(12)) << 32;
    if length > rest - HEAD as u64 {
        return Ok(None);
    }
    payload.clear();
    input.take(length).read_to_end(payload)?;
    Ok(Some((key, checksum(key, payload) == word(16))))
}

/// Writes at a place, whatever the position is that threads share.
#[cfg(unix)]
fn write_at(file: &File, bytes: &[u8], start: u64) -> io::Result<()> {
    std::os::unix::fs::FileExt::write_all_at(file, bytes, start)
}

#[cfg(windows)]
fn write_at(file: &File, mut bytes: &[u8], mut start: u64) -> io::Result<()> {
    while !bytes.is_empty() {
        match std::os::windows::fs::FileExt::seek_write(file, bytes, start)? {
            0 => return Err(io::ErrorKind::WriteZero.into()),
            count => (bytes, start) = (&bytes[count..], start + count as u64),
        }
    }
    Ok(())
}

/// Reads at a place, whatever the position is that threads share.
#[cfg(unix)]
fn read_at(file: &File, buffer: &mut [u8], start: u64) -> io::Result<()> {
    std::os::unix::fs::FileExt::read_exact_at(file, buffer, start)
}

#[cfg(windows)]
fn read_at(file: &File, mut buffer: &mut [u8], mut start: u64) -> io::Result<()> {
    while !buffer.is_empty() {
        match std::os::windows::fs::FileExt::seek_read(file, buffer, start)? {
            0 => return Err(io::ErrorKind::UnexpectedEof.into()),
            count => (buffer, start) = (&mut buffer[count..], start + count as u64),
        }
    }
    Ok(())
}
