use crate::assemble::{Assembly, assemble};
use crate::buffers::GpuVec;
use crate::layout::{ClipVertex, FrameParams, ScreenVertex};
use crate::pass::{Resolve, bind_buffers};
use crate::surface::check_length;
use crate::{Error, Frame, Gpu, Target, View};
use wgpu::BufferUsages as Usage;

/// Buffers with their binding numbers, as a pass that resolves reads them beside the screen.
pub(super) type Inputs = Vec<(u32, wgpu::Buffer)>;

/// A mesh and its triangles on the screen: what all renderers have in common.
#[derive(Debug)]
pub(super) struct Stage {
    pub(super) gpu: Gpu,
    positions: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
    screen: Screen,
    /// The view that `screen` was made for.
    projected: Option<View>,
    /// The images of the last render.
    target: Option<Target>,
}

impl Stage {
    /// - `resolve`, `inputs`: the pass that resolves, and what it reads
    pub(super) fn new(
        gpu: &Gpu,
        positions: &[[f32; 3]],
        triangles: &[[u32; 3]],
        resolve: &Resolve,
        inputs: Inputs,
    ) -> Result<Self, Error> {
        let screen = Screen::new(gpu, positions.len(), triangles.len(), resolve, inputs)?;
        Ok(Self {
            gpu: gpu.clone(),
            positions: positions.to_vec(),
            triangles: triangles.to_vec(),
            screen,
            projected: None,
            target: None,
        })
    }

    pub(super) fn vertex_count(&self) -> usize {
        self.positions.len()
    }

    /// Moves the vertices.
    pub(super) fn set_positions(&mut self, positions: &[[f32; 3]]) {
        self.positions.clear();
        self.positions.extend_from_slice(positions);
        self.projected = None;
    }

    /// Replaces what the pass that resolves reads.
    pub(super) fn set_inputs(&mut self, resolve: &Resolve, inputs: Inputs) -> Result<(), Error> {
        self.screen.inputs = inputs;
        self.screen.bind(&self.gpu, resolve)
    }

    /// Images for a view: those of the last render if they fit.
    pub(super) fn take_target(&mut self, view: &View) -> Result<Target, Error> {
        view.check()?;
        match self.target.take().filter(|target| fits(target, view)) {
            Some(target) => Ok(target),
            None => Target::new(&self.gpu, view.width, view.height, view.samples),
        }
    }

    /// Reads images back and keeps them for the next render.
    pub(super) fn read_target(&mut self, target: Target) -> Result<Frame, Error> {
        let frame = target.read(&self.gpu)?;
        self.target = Some(target);
        Ok(frame)
    }

    /// Projects the mesh, if the view or the mesh has changed.
    pub(super) fn project(&mut self, view: &View, target: &Target, resolve: &Resolve) -> Result<(), Error> {
        view.check()?;
        if !fits(target, view) {
            let [given, made] =
                [[view.width, view.height, view.samples], [target.width(), target.height(), target.samples()]];
            return Err(Error::View(format!(
                "a view of size and samples {given:?} was drawn into images made for {made:?}"
            )));
        }
        if self.projected != Some(*view) {
            self.projected = None;
            let assembly = assemble(&self.positions, &self.triangles, view);
            self.screen.upload(&self.gpu, &assembly, view, self.positions.len(), resolve)?;
            self.projected = Some(*view);
        }
        Ok(())
    }

    /// Records the nearest triangles and their pixels.
    ///
    /// - `images`: of the target, bound for `resolve`
    pub(super) fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        target: &Target,
        resolve: &Resolve,
        images: &wgpu::BindGroup,
    ) {
        let draw_surface = &self.gpu.passes().draw_surface;
        draw_surface.record(encoder, &self.screen.draw_group, self.screen.corner_count, target);
        resolve.record(encoder, &self.screen.resolve_group, images, target);
    }

    pub(super) fn check_vertices(&self, what: &'static str, given: usize) -> Result<(), Error> {
        let needed = self.vertex_count();
        check_length(what, given, "entries", needed, || format!("a surface of {needed} vertices"))
    }
}

/// Records commands and submits them.
pub(super) fn submit(
    gpu: &Gpu,
    step: &'static str,
    record: impl FnOnce(&mut wgpu::CommandEncoder) -> Result<(), Error>,
) -> Result<(), Error> {
    gpu.checked(step, || {
        let mut encoder = gpu.device().create_command_encoder(&Default::default());
        record(&mut encoder)?;
        gpu.queue().submit([encoder.finish()]);
        Ok(())
    })?
}

fn fits(target: &Target, view: &View) -> bool {
    [target.width(), target.height(), target.samples()] == [view.width, view.height, view.samples]
}

/// The surface on the screen, for one view.
#[derive(Debug)]
struct Screen {
    frame: GpuVec<FrameParams>,
    vertices: GpuVec<ScreenVertex>,
    corners: GpuVec<[u32; 3]>,
    clips: GpuVec<ClipVertex>,
    corner_count: u32,
    inputs: Inputs,
    draw_group: wgpu::BindGroup,
    resolve_group: wgpu::BindGroup,
}

impl Screen {
    fn new(
        gpu: &Gpu,
        vertex_count: usize,
        triangle_count: usize,
        resolve: &Resolve,
        inputs: Inputs,
    ) -> Result<Self, Error> {
        let frame = GpuVec::new(gpu, "frame parameters", Usage::UNIFORM, 1)?;
        let vertices = GpuVec::new(gpu, "vertices on the screen", Usage::STORAGE, vertex_count)?;
        let corners = GpuVec::new(gpu, "triangles on the screen", Usage::STORAGE, triangle_count)?;
        let clips = GpuVec::new(gpu, "clipped vertices", Usage::STORAGE, 1)?;
        let buffers = [frame.buffer(), vertices.buffer(), corners.buffer(), clips.buffer()];
        let [draw_group, resolve_group] = bind_screen(gpu, buffers, resolve, &inputs)?;
        Ok(Self { frame, vertices, corners, clips, corner_count: 0, inputs, draw_group, resolve_group })
    }

    fn upload(
        &mut self,
        gpu: &Gpu,
        assembly: &Assembly,
        view: &View,
        vertex_count: usize,
        resolve: &Resolve,
    ) -> Result<(), Error> {
        let params = FrameParams {
            size: [view.width, view.height],
            samples: view.samples,
            vertex_count: vertex_count as u32,
            front_count: assembly.front_count as u32,
            zero: 0,
            padding: [0; 2],
        };
        self.frame.write(gpu, &[params])?;
        let grown = self.vertices.write(gpu, &assembly.vertices)?
            | self.corners.write(gpu, &assembly.triangles)?
            | self.clips.write(gpu, &assembly.clips)?;
        self.corner_count = 3 * assembly.triangles.len() as u32;
        if grown { self.bind(gpu, resolve) } else { Ok(()) }
    }

    fn bind(&mut self, gpu: &Gpu, resolve: &Resolve) -> Result<(), Error> {
        let buffers = [self.frame.buffer(), self.vertices.buffer(), self.corners.buffer(), self.clips.buffer()];
        [self.draw_group, self.resolve_group] = bind_screen(gpu, buffers, resolve, &self.inputs)?;
        Ok(())
    }
}

/// Binds frame, vertices and corners for drawing, and with clips and inputs for resolving.
fn bind_screen(
    gpu: &Gpu,
    screen: [&wgpu::Buffer; 4],
    resolve: &Resolve,
    inputs: &Inputs,
) -> Result<[wgpu::BindGroup; 2], Error> {
    let numbered = (0..).zip(screen);
    let draw: Vec<_> = numbered.clone().take(3).collect();
    let resolved: Vec<_> = numbered.chain(inputs.iter().map(|(binding, buffer)| (*binding, buffer))).collect();
    gpu.checked("binding buffers", || {
        [
            bind_buffers(gpu.device(), &gpu.passes().draw_surface.layout(), &draw),
            bind_buffers(gpu.device(), &resolve.screen_layout(), &resolved),
        ]
    })
}
