use crate::Error;
use crate::pass::{LobePasses, Passes};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// A GPU with the passes of this crate compiled for it. Clones share the device.
#[derive(Debug, Clone)]
pub struct Gpu {
    device: wgpu::Device,
    queue: wgpu::Queue,
    info: wgpu::AdapterInfo,
    description: String,
    faults: Faults,
    passes: Arc<Passes>,
    /// Compiled when first needed.
    lobe_passes: Arc<OnceLock<Result<LobePasses, Error>>>,
}

impl Gpu {
    /// A device that draws to memory, with no window.
    ///
    /// Adapters are tried in this order until one compiles the passes: discrete, integrated, virtual, other, software; among
    /// equals Vulkan, Metal and Direct3D before OpenGL. The environment variables `WGPU_BACKEND` (`vulkan`, `gl`, `metal`,
    /// `dx12`; several with commas) and `WGPU_ADAPTER_NAME` (part of a name, any case) restrict the choice.
    ///
    /// # Errors
    /// [`Error::NoAdapter`] with the account of what was found, as [`Gpu::description`] gives it on success.
    pub fn headless() -> Result<Self, Error> {
        let mut account = Account::new();
        match account.open_best() {
            Some(gpu) => Ok(Self { description: account.text(), ..gpu }),
            None => Err(Error::NoAdapter(account.text())),
        }
    }

    /// Uses the device of a window.
    ///
    /// The device must have been made with at least [`Gpu::required_limits`]; no feature is needed. Its error handlers are
    /// left as they are.
    ///
    /// # Errors
    /// [`Error::Limit`] if a limit is too small, [`Error::Device`] if a pass does not compile.
    pub fn from_parts(device: wgpu::Device, queue: wgpu::Queue, info: wgpu::AdapterInfo) -> Result<Self, Error> {
        let description = format!("{}: the window's adapter", describe(&info));
        Self::from_device(device, queue, info, description, Faults::default())
    }

    /// The limits to ask of an adapter: what the passes need at least, and as large buffers and textures as it has.
    pub fn required_limits(adapter: &wgpu::Adapter) -> wgpu::Limits {
        let limits = adapter.limits();
        wgpu::Limits {
            max_buffer_size: limits.max_buffer_size,
            max_storage_buffer_binding_size: limits.max_storage_buffer_binding_size,
            max_storage_buffers_per_shader_stage: limits.max_storage_buffers_per_shader_stage.min(LOBE_STORAGE_BUFFERS),
            ..wgpu::Limits::downlevel_defaults().using_resolution(limits)
        }
    }

    /// Name and driver of the adapter, as in "llvmpipe (LLVM 15.0.6, 256 bits) (Vulkan, software)".
    pub fn adapter_name(&self) -> String {
        describe(&self.info)
    }

    /// Which adapters were found, which one is used and why; several lines.
    pub fn description(&self) -> &str {
        &self.description
    }

    /// What wgpu knows about the adapter.
    pub fn info(&self) -> &wgpu::AdapterInfo {
        &self.info
    }

    /// The device, for a caller that records passes of its own.
    pub fn device(&self) -> &wgpu::Device {
        &self.device
    }

    /// The queue that everything is submitted to.
    pub fn queue(&self) -> &wgpu::Queue {
        &self.queue
    }

    pub(crate) fn passes(&self) -> &Passes {
        &self.passes
    }

    /// The passes of lobes. They take more storage buffers than the others, so that not every device has them.
    pub(crate) fn lobe_passes(&self) -> Result<&LobePasses, Error> {
        let compile = || {
            let (needed, limit) = (LOBE_STORAGE_BUFFERS, self.device.limits().max_storage_buffers_per_shader_stage);
            if limit < needed {
                let what = "shading lobes".into();
                return Err(self.limit_error(what, needed.into(), "storage buffers per shader", limit.into()));
            }
            self.checked("compiling the shaders", || LobePasses::new(&self.device))
        };
        self.lobe_passes.get_or_init(compile).as_ref().map_err(Clone::clone)
    }

    /// Fails if `bytes` do not fit one storage binding.
    pub(crate) fn check_binding(&self, what: impl Into<String>, bytes: u64) -> Result<(), Error> {
        let limit = self.max_binding();
        match bytes <= limit {
            true => Ok(()),
            false => Err(self.limit_error(what.into(), bytes, "bytes in one binding", limit)),
        }
    }

    /// The largest buffer that a shader can be given whole.
    pub(crate) fn max_binding(&self) -> u64 {
        let limits = self.device.limits();
        limits.max_storage_buffer_binding_size.min(limits.max_buffer_size)
    }

    pub(crate) fn limit_error(&self, what: String, needed: u64, unit: &'static str, limit: u64) -> Error {
        Error::Limit { what, needed, unit, limit, adapter: self.adapter_name() }
    }

    /// Runs `work` and turns what the driver reports meanwhile into an error.
    pub(crate) fn checked<T>(&self, step: &'static str, work: impl FnOnce() -> T) -> Result<T, Error> {
        checked(&self.device, &self.faults, step, work)
    }

    fn open(adapter: &wgpu::Adapter) -> Result<Self, Error> {
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("prt-gpu"),
            required_limits: Self::required_limits(adapter),
            ..Default::default()
        };
        let opened = pollster::block_on(adapter.request_device(&descriptor));
        let (device, queue) = opened
            .map_err(|error| Error::Device { step: "opening the device", message: first_lines(&error.to_string()) })?;
        let faults = Faults::watch(&device);
        Self::from_device(device, queue, adapter.get_info(), String::new(), faults)
    }

    fn from_device(
        device: wgpu::Device,
        queue: wgpu::Queue,
        info: wgpu::AdapterInfo,
        description: String,
        faults: Faults,
    ) -> Result<Self, Error> {
        check_limits(&device.limits(), &info)?;
        let passes = Arc::new(checked(&device, &faults, "compiling the shaders", || Passes::new(&device))?);
        Ok(Self { device, queue, info, description, faults, passes, lobe_passes: Arc::default() })
    }
}

/// What the driver reported outside of [`checked`]: the loss of the device above all.
#[derive(Debug, Clone, Default)]
struct Faults(Arc<Mutex<Option<String>>>);

impl Faults {
    /// Collects the faults of a device, which would otherwise end the program.
    fn watch(device: &wgpu::Device) -> Self {
        let faults = Self::default();
        let (uncaptured, lost) = (faults.clone(), faults.clone());
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| uncaptured.record(error.to_string())));
        device.set_device_lost_callback(move |_, message| lost.record(format!("the device was lost: {message}")));
        faults
    }

    fn record(&self, fault: String) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(fault);
    }

    fn get(&self) -> Option<String> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

fn checked<T>(
    device: &wgpu::Device,
    faults: &Faults,
    step: &'static str,
    work: impl FnOnce() -> T,
) -> Result<T, Error> {
    let filters = [wgpu::ErrorFilter::OutOfMemory, wgpu::ErrorFilter::Validation, wgpu::ErrorFilter::Internal];
    let mut scopes: Vec<_> = filters.map(|filter| device.push_error_scope(filter)).into();
    let value = work();
    let mut reported = None;
    while let Some(scope) = scopes.pop() {
        reported = reported.or(pollster::block_on(scope.pop()).map(|error| error.to_string()));
    }
    match reported.or_else(|| faults.get()) {
        Some(message) => Err(Error::Device { step, message: first_lines(&message) }),
        None => Ok(value),
    }
}

/// wgpu's reports carry whole shaders; the cause stands in the first lines.
fn first_lines(message: &str) -> String {
    let lines: Vec<&str> = message.lines().map(str::trim).filter(|line| !line.is_empty()).take(4).collect();
    lines.join("; ")
}

/// Storage buffers of one shader stage that [`Passes`] uses at most.
const STORAGE_BUFFERS: u32 = 4;

/// Storage buffers of one shader stage that [`LobePasses`] uses at most: WebGPU's default.
const LOBE_STORAGE_BUFFERS: u32 = 8;

fn check_limits(limits: &wgpu::Limits, info: &wgpu::AdapterInfo) -> Result<(), Error> {
    let needs = [
        (
            "shading vertices",
            "storage buffers per shader",
            STORAGE_BUFFERS,
            limits.max_storage_buffers_per_shader_stage,
        ),
        ("resolving samples", "storage textures per shader", 2, limits.max_storage_textures_per_shader_stage),
        ("shading vertices", "invocations per workgroup", 64, limits.max_compute_invocations_per_workgroup),
    ];
    match needs.into_iter().find(|&(_, _, needed, limit)| limit < needed) {
        None => Ok(()),
        Some((what, unit, needed, limit)) => Err(Error::Limit {
            what: what.into(),
            needed: needed.into(),
            unit,
            limit: limit.into(),
            adapter: describe(info),
        }),
    }
}

fn describe(info: &wgpu::AdapterInfo) -> String {
    let kind = match info.device_type {
        wgpu::DeviceType::DiscreteGpu => "discrete",
        wgpu::DeviceType::IntegratedGpu => "integrated",
        wgpu::DeviceType::VirtualGpu => "virtual",
        wgpu::DeviceType::Cpu => "software",
        wgpu::DeviceType::Other => "unknown kind",
    };
    format!("{} ({}, {kind})", info.name, info.backend)
}

/// Smaller is tried earlier.
fn rank(info: &wgpu::AdapterInfo) -> (u8, u8) {
    let kind = match info.device_type {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    };
    (kind, u8::from(info.backend == wgpu::Backend::Gl))
}

/// The adapters of this machine, best first, and what became of each.
#[derive(Debug)]
struct Account {
    searched: String,
    entries: Vec<(wgpu::Adapter, String)>,
}

impl Account {
    fn new() -> Self {
        let mut adapters = match wgpu::Backends::from_env() {
            Some(backends) => find(backends),
            None => find_native_or_gl(),
        };
        adapters.sort_by_key(|adapter| rank(&adapter.get_info()));
        let entries = adapters.into_iter().map(|adapter| (adapter, "not needed".to_string())).collect();
        Self { searched: searched(), entries }
    }

    /// Opens the first adapter that runs the passes, and notes what became of it and of those before it.
    fn open_best(&mut self) -> Option<Gpu> {
        let wanted = wanted_name().unwrap_or_default();
        for (adapter, fate) in &mut self.entries {
            if !adapter.get_info().name.to_lowercase().contains(&wanted) {
                *fate = "passed over, WGPU_ADAPTER_NAME names another".to_string();
                continue;
            }
            match Gpu::open(adapter) {
                Err(error) => *fate = format!("refused, {error}"),
                Ok(gpu) => {
                    *fate = "used, the first in order of preference that runs the passes".to_string();
                    return Some(gpu);
                }
            }
        }
        None
    }

    fn text(&self) -> String {
        let line = |(adapter, fate): &(wgpu::Adapter, String)| format!("\n  {}: {fate}", describe(&adapter.get_info()));
        let is_restricted = std::env::var_os("WGPU_BACKEND").is_some();
        match self.entries.is_empty() {
            true => {
                format!("{}, found none{}", self.searched, if is_restricted { "" } else { "; is a driver installed?" })
            }
            false => format!(
                "{}, found {}:{}",
                self.searched,
                self.entries.len(),
                self.entries.iter().map(line).collect::<String>()
            ),
        }
    }
}

fn find(backends: wgpu::Backends) -> Vec<wgpu::Adapter> {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle_from_env();
    descriptor.backends = backends;
    pollster::block_on(wgpu::Instance::new(descriptor).enumerate_adapters(backends))
}

/// OpenGL repeats what the native interfaces find, starts slowly, and its libraries print messages of their own.
fn find_native_or_gl() -> Vec<wgpu::Adapter> {
    let native = find(wgpu::Backends::all() - wgpu::Backends::GL);
    if native.is_empty() { find(wgpu::Backends::GL) } else { native }
}

fn wanted_name() -> Option<String> {
    std::env::var("WGPU_ADAPTER_NAME").ok().filter(|name| !name.is_empty()).map(|name| name.to_lowercase())
}

/// What was looked for, and where that was set.
fn searched() -> String {
    let backends = match std::env::var("WGPU_BACKEND") {
        Ok(names) if wgpu::Backends::from_comma_list(&names).is_empty() => {
            return format!("WGPU_BACKEND names no backend in {names:?}; vulkan, gl, metal and dx12 are known");
        }
        Ok(names) => format!("looked for adapters of {names:?} (WGPU_BACKEND)"),
        Err(_) => "looked for adapters of Vulkan, Metal and DirectX 12, and of OpenGL if there are none".to_string(),
    };
    match wanted_name() {
        Some(name) => format!("{backends} with {name:?} in their name (WGPU_ADAPTER_NAME)"),
        None => backends,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reports_are_shortened_to_their_cause() {
        let report = "Validation Error\n\nCaused by:\n  In Device::create_buffer\n    too large\n    and more\n";
        assert_eq!(first_lines(report), "Validation Error; Caused by:; In Device::create_buffer; too large");
    }

    #[test]
    fn limits_that_are_too_small_are_named() {
        let info = wgpu::AdapterInfo::new(wgpu::DeviceType::Cpu, wgpu::Backend::Gl);
        let error = check_limits(&wgpu::Limits::downlevel_webgl2_defaults(), &info).map_err(|e| e.to_string());
        assert!(error.is_err_and(|text| text.starts_with("shading vertices needs 4 storage buffers per shader")));
        assert_eq!(check_limits(&wgpu::Limits::downlevel_defaults(), &info), Ok(()));
    }
}
