//! Typed arrays in a glTF document.

use gltf::json::Index;
use gltf::json::accessor::{ComponentType, GenericComponentType, IndexComponentType, sparse};
use gltf::json::validation::{Checked, USize64};

use super::document::Document;
use super::fault::Fault;

type Json = gltf::json::Accessor;

/// An array of scalars, vectors or matrices whose every element is known to lie in its buffer.
#[derive(Debug, Clone)]
pub(super) struct Accessor<'a> {
    /// `None`: all zero, but for what `sparse` replaces.
    dense: Option<Elements<'a>>,
    count: usize,
    components: usize,
    component: ComponentType,
    normalized: bool,
    /// Indices, increasing, and the values in their place.
    sparse: Option<(Elements<'a>, ComponentType, Elements<'a>)>,
    sparse_count: usize,
}

/// Elements of one size at a constant distance.
#[derive(Debug, Clone, Copy)]
struct Elements<'a> {
    bytes: &'a [u8],
    stride: usize,
}

impl<'a> Accessor<'a> {
    /// Checks the array against its buffer.
    ///
    /// - `components`: how many numbers an element may have
    pub(super) fn new(document: &'a Document<'_>, index: Index<Json>, components: &[usize]) -> Result<Self, Fault> {
        let json = document.get(index, "accessor")?;
        let fault = |reason: &str| Fault::malformed(format!("accessor {index} {reason}"));
        let Checked::Valid(GenericComponentType(component)) = json.component_type else {
            return Err(fault("has an unknown component type"));
        };
        let Checked::Valid(kind) = json.type_ else { return Err(fault("has an unknown type")) };
        if !components.contains(&kind.multiplicity()) {
            return Err(fault(&format!("has elements of type {kind:?}, which do not fit its use")));
        }
        let count = size(json.count).filter(|&count| count <= document.data_bytes());
        let count =
            count.ok_or_else(|| fault(&format!("claims {} elements, more than the data hold", json.count.0)))?;
        let mut accessor = Self {
            dense: None,
            count,
            components: kind.multiplicity(),
            component,
            normalized: json.normalized,
            sparse: None,
            sparse_count: 0,
        };
        accessor.dense = accessor.dense_elements(document, json).map_err(|reason| reason.into_fault(index))?;
        if let Some(sparse) = &json.sparse {
            accessor.add_sparse(document, sparse).map_err(|reason| reason.into_fault(index))?;
        }
        Ok(accessor)
    }

    fn element_bytes(&self) -> usize {
        self.components * self.component.size()
    }

    fn dense_elements(&self, document: &'a Document<'_>, json: &Json) -> Result<Option<Elements<'a>>, Reason> {
        let Some(view) = json.buffer_view else {
            return match document.uses(&["KHR_draco_mesh_compression"]) {
                Some(extension) if json.sparse.is_none() => {
                    Err(Fault::unsupported(format!("the glTF extension {extension} is")).into())
                }
                _ => Ok(None),
            };
        };
        let (bytes, stride) = document.view(view)?;
        let offset = json.byte_offset.unwrap_or_default();
        Elements::new(bytes, offset, stride, self.element_bytes(), self.count).map(Some)
    }

    fn add_sparse(&mut self, document: &'a Document<'_>, json: &sparse::Sparse) -> Result<(), Reason> {
        let Checked::Valid(IndexComponentType(kind)) = json.indices.component_type else {
            return Err(Reason::Text("has sparse indices of an unknown type".to_owned()));
        };
        let count = size(json.count).filter(|&count| count <= self.count);
        let count = count.ok_or_else(|| Reason::Text("replaces more elements than it has".to_owned()))?;
        let (bytes, _) = document.view(json.indices.buffer_view)?;
        let indices = Elements::new(bytes, json.indices.byte_offset, None, kind.size(), count)?;
        let (bytes, _) = document.view(json.values.buffer_view)?;
        let values = Elements::new(bytes, json.values.byte_offset, None, self.element_bytes(), count)?;
        let at = |i: usize| component(indices.element(i), kind, 0) as usize;
        let increases = (1..count).all(|i| at(i - 1) < at(i));
        if !increases || count > 0 && at(count - 1) >= self.count {
            return Err(Reason::Text("has sparse indices that do not increase or lie past its end".to_owned()));
        }
        self.sparse = Some((indices, kind, values));
        self.sparse_count = count;
        Ok(())
    }

    pub(super) fn count(&self) -> usize {
        self.count
    }

    pub(super) fn is_float(&self) -> bool {
        self.component == ComponentType::F32
    }

    /// The same array with integers read as fractions of their largest value, as colours and weights always are.
    pub(super) fn normalized(self) -> Self {
        Self { normalized: true, ..self }
    }

    /// The first `N` numbers of an element; missing ones are zero.
    pub(super) fn get<const N: usize>(&self, index: usize) -> [f64; N] {
        let mut values = [0.0; N];
        if let Some(bytes) = self.element(index) {
            for (i, value) in values.iter_mut().enumerate().take(self.components) {
                let raw = component(bytes, self.component, i);
                *value = if self.normalized { normalize(raw, self.component) } else { raw };
            }
        }
        values
    }

    /// An element as an unsigned integer.
    pub(super) fn index(&self, index: usize) -> u32 {
        let [value] = self.get(index);
        value as u32
    }

    fn element(&self, index: usize) -> Option<&'a [u8]> {
        let replaced = self.sparse.as_ref().and_then(|(indices, kind, values)| {
            let (mut low, mut high) = (0, self.sparse_count);
            while low < high {
                let middle = usize::midpoint(low, high);
                match (component(indices.element(middle), *kind, 0) as usize).cmp(&index) {
                    std::cmp::Ordering::Equal => return Some(values.element(middle)),
                    std::cmp::Ordering::Less => low = middle + 1,
                    std::cmp::Ordering::Greater => high = middle,
                }
            }
            None
        });
        replaced.or_else(|| self.dense.map(|dense| dense.element(index)))
    }
}

/// Why an accessor is refused: its own fault, to be named, or somebody else's.
enum Reason {
    Text(String),
    Fault(Fault),
}

impl Reason {
    fn into_fault(self, index: Index<Json>) -> Fault {
        match self {
            Self::Text(text) => Fault::malformed(format!("accessor {index} {text}")),
            Self::Fault(fault) => fault,
        }
    }
}

impl From<Fault> for Reason {
    fn from(fault: Fault) -> Self {
        Self::Fault(fault)
    }
}

impl<'a> Elements<'a> {
    fn new(
        bytes: &'a [u8],
        offset: USize64,
        stride: Option<usize>,
        element: usize,
        count: usize,
    ) -> Result<Self, Reason> {
        let stride = stride.unwrap_or(element);
        if stride < element {
            return Err(Reason::Text(format!("has elements of {element} bytes at a distance of {stride}")));
        }
        let last = count.checked_sub(1).map_or(Some(0), |last| last.checked_mul(stride)?.checked_add(element));
        let offset = size(offset).filter(|&offset| offset <= bytes.len());
        match offset.zip(last) {
            Some((offset, length)) if length <= bytes.len() - offset => Ok(Self { bytes: &bytes[offset..], stride }),
            _ => Err(Reason::Text(format!("needs more bytes than its buffer view has ({})", bytes.len()))),
        }
    }

    fn element(&self, index: usize) -> &'a [u8] {
        &self.bytes[index * self.stride..]
    }
}

fn size(value: USize64) -> Option<usize> {
    usize::try_from(value.0).ok()
}

/// Number `i` of an element, as stored.
fn component(element: &[u8], kind: ComponentType, i: usize) -> f64 {
    let at = i * kind.size();
    let two = || [element[at], element[at + 1]];
    let four = || [element[at], element[at + 1], element[at + 2], element[at + 3]];
    match kind {
        ComponentType::I8 => f64::from(element[at] as i8),
        ComponentType::U8 => f64::from(element[at]),
        ComponentType::I16 => f64::from(i16::from_le_bytes(two())),
        ComponentType::U16 => f64::from(u16::from_le_bytes(two())),
        ComponentType::U32 => f64::from(u32::from_le_bytes(four())),
        ComponentType::F32 => f64::from(f32::from_le_bytes(four())),
    }
}

/// glTF 2.0, section 3.11 (animations) and the table of KHR_mesh_quantization.
fn normalize(value: f64, kind: ComponentType) -> f64 {
    match kind {
        ComponentType::I8 => (value / 127.0).max(-1.0),
        ComponentType::U8 => value / 255.0,
        ComponentType::I16 => (value / 32767.0).max(-1.0),
        ComponentType::U16 => value / 65535.0,
        ComponentType::U32 => value / f64::from(u32::MAX),
        ComponentType::F32 => value,
    }
}
