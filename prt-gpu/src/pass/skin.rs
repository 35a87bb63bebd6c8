use super::{bind_buffers, compute_pipeline};
use crate::buffers::GpuVec;
use crate::layout::{self, Influence, SkinParams};
use crate::shaders::SKIN;
use crate::skin::check_joints;
use crate::{Error, Gpu, PoseFrames, Skin, cpu};
use wgpu::BufferUsages as Usage;

/// Invocations per workgroup, as in the shader.
const WORKGROUP: u32 = 64;

/// Positions and frames of a pose.
#[derive(Debug)]
pub(crate) struct SkinPass {
    pipeline: wgpu::ComputePipeline,
}

impl SkinPass {
    pub(crate) fn new(device: &wgpu::Device) -> Self {
        Self { pipeline: compute_pipeline(device, SKIN) }
    }

    fn record(&self, encoder: &mut wgpu::CommandEncoder, skinning: &Skinning) {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &skinning.bind_group, &[]);
        pass.dispatch_workgroups(skinning.groups[0], skinning.groups[1], 1);
    }
}

/// A skin on the GPU, and what the CPU needs of it.
#[derive(Debug)]
pub(crate) struct Skinning {
    rest: Vec<[f32; 3]>,
    influences: Vec<Influence>,
    joint_count: usize,
    joints: GpuVec<[[f32; 4]; 4]>,
    bind_group: wgpu::BindGroup,
    groups: [u32; 2],
    is_stale: bool,
}

impl Skinning {
    /// - `pose`: `[V, 3]`, what the pass writes
    pub(crate) fn new(gpu: &Gpu, skin: &Skin<'_>, kind: PoseFrames, pose: &wgpu::Buffer) -> Result<Self, Error> {
        let vertices = skin.positions.len();
        let max_side = gpu.device().limits().max_compute_workgroups_per_dimension;
        let group_count = (vertices as u32).div_ceil(WORKGROUP);
        let groups = layout::split_dispatch(group_count, max_side).ok_or_else(|| {
            gpu.limit_error("skinning".into(), group_count.into(), "workgroups", u64::from(max_side).pow(2))
        })?;
        let params = SkinParams {
            vertex_count: vertices as u32,
            row_length: groups[0] * WORKGROUP,
            from_rest: u32::from(kind == PoseFrames::FromRest),
            padding: 0,
        };
        let influence = |(&joints, &weights): (&[u32; 4], &[f32; 4])| Influence { weights, joints };
        let influences: Vec<Influence> = skin.joints.iter().zip(skin.weights).map(influence).collect();
        let params = GpuVec::with_data(gpu, "skin parameters", Usage::UNIFORM, &[params])?;
        let rest_pose = layout::pack_pose(skin.positions, skin.frames);
        let rest_pose = GpuVec::with_data(gpu, "rest pose", Usage::STORAGE, &rest_pose)?;
        let influence_buffer = GpuVec::with_data(gpu, "joints of vertices", Usage::STORAGE, &influences)?;
        let joints = GpuVec::new(gpu, "joint matrices", Usage::STORAGE, skin.joint_count())?;
        let bindings = gpu.lobe_passes()?.skin.pipeline.get_bind_group_layout(0);
        let buffers = [
            (0, params.buffer()),
            (1, rest_pose.buffer()),
            (2, influence_buffer.buffer()),
            (3, joints.buffer()),
            (4, pose),
        ];
        let bind_group = gpu.checked("binding buffers", || bind_buffers(gpu.device(), &bindings, &buffers))?;
        let joint_count = skin.joint_count();
        Ok(Self { rest: skin.positions.to_vec(), influences, joint_count, joints, bind_group, groups, is_stale: false })
    }

    /// Uploads the matrices of a pose, and returns its positions.
    pub(crate) fn set_joints(&mut self, gpu: &Gpu, matrices: &[[[f32; 4]; 4]]) -> Result<Vec<[f32; 3]>, Error> {
        check_joints(matrices, self.joint_count)?;
        self.joints.write(gpu, &matrices[..self.joint_count])?;
        self.is_stale = true;
        Ok(cpu::skinned_positions(&self.rest, &self.influences, matrices))
    }

    /// Poses the vertices, if the joints have moved.
    pub(crate) fn record(&mut self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder) -> Result<(), Error> {
        if std::mem::take(&mut self.is_stale) {
            gpu.lobe_passes()?.skin.record(encoder, self);
        }
        Ok(())
    }
}
