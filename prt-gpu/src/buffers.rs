//! Upload and read-back.

use crate::layout::padded_row_bytes;
use crate::{Error, Gpu};
use bytemuck::Pod;
use std::marker::PhantomData;
use std::sync::mpsc;

/// A storage or uniform buffer of `T` that grows when more is written to it.
#[derive(Debug)]
pub(crate) struct GpuVec<T> {
    buffer: wgpu::Buffer,
    what: &'static str,
    usage: wgpu::BufferUsages,
    element: PhantomData<T>,
}

impl<T: Pod> GpuVec<T> {
    /// Room for `capacity` elements, at least one: empty bindings are not allowed.
    ///
    /// - `what`: what it holds, for messages
    pub(crate) fn new(
        gpu: &Gpu,
        what: &'static str,
        usage: wgpu::BufferUsages,
        capacity: usize,
    ) -> Result<Self, Error> {
        let bytes = (capacity.max(1) * size_of::<T>()) as u64;
        gpu.check_binding(what, bytes)?;
        let usage = usage | wgpu::BufferUsages::COPY_DST;
        let descriptor = wgpu::BufferDescriptor { label: Some(what), size: bytes, usage, mapped_at_creation: false };
        let buffer = gpu.checked("allocating a buffer", || gpu.device().create_buffer(&descriptor))?;
        Ok(Self { buffer, what, usage, element: PhantomData })
    }

    /// A buffer that holds `data`.
    pub(crate) fn with_data(
        gpu: &Gpu,
        what: &'static str,
        usage: wgpu::BufferUsages,
        data: &[T],
    ) -> Result<Self, Error> {
        let mut buffer = Self::new(gpu, what, usage, data.len())?;
        buffer.write(gpu, data)?;
        Ok(buffer)
    }

    /// Replaces the first elements. Returns whether the buffer was replaced by a larger one.
    pub(crate) fn write(&mut self, gpu: &Gpu, data: &[T]) -> Result<bool, Error> {
        let bytes: &[u8] = bytemuck::cast_slice(data);
        let grows = bytes.len() as u64 > self.buffer.size();
        if grows {
            // Half as much again, so that a camera that moves close does not reallocate every frame.
            let room = data.len() + data.len() / 2;
            let fits = (room * size_of::<T>()) as u64 <= gpu.max_binding();
            *self = Self::new(gpu, self.what, self.usage, if fits { room } else { data.len() })?;
        }
        gpu.checked("uploading", || gpu.queue().write_buffer(&self.buffer, 0, bytes))?;
        Ok(grows)
    }

    pub(crate) fn buffer(&self) -> &wgpu::Buffer {
        &self.buffer
    }
}

/// Reads back the first `count` elements of a buffer with usage `COPY_SRC`.
pub(crate) fn read_buffer<T: Pod>(gpu: &Gpu, buffer: &wgpu::Buffer, count: usize) -> Result<Vec<T>, Error> {
    let mut out = vec![T::zeroed(); count];
    let bytes = size_of_val(&*out) as u64;
    if bytes > 0 {
        let copy = |encoder: &mut wgpu::CommandEncoder, staging: &wgpu::Buffer| {
            encoder.copy_buffer_to_buffer(buffer, 0, staging, 0, bytes);
        };
        copy_out(gpu, bytes, copy, |mapped| bytemuck::cast_slice_mut(&mut out).copy_from_slice(mapped))?;
    }
    Ok(out)
}

/// Reads back a texture with usage `COPY_SRC`; `T` is a texel. Rows from the top, without padding.
pub(crate) fn read_texture<T: Pod>(gpu: &Gpu, texture: &wgpu::Texture) -> Result<Vec<T>, Error> {
    let size = texture.size();
    let mut out = vec![T::zeroed(); size.width as usize * size.height as usize];
    let row_bytes = padded_row_bytes(size.width, size_of::<T>() as u32);
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row_bytes), rows_per_image: None };
    let copy = |encoder: &mut wgpu::CommandEncoder, buffer: &wgpu::Buffer| {
        encoder.copy_texture_to_buffer(texture.as_image_copy(), wgpu::TexelCopyBufferInfo { buffer, layout }, size);
    };
    copy_out(gpu, u64::from(row_bytes) * u64::from(size.height), copy, |mapped| {
        for (row, padded) in out.chunks_exact_mut(size.width as usize).zip(mapped.chunks_exact(row_bytes as usize)) {
            let row: &mut [u8] = bytemuck::cast_slice_mut(row);
            row.copy_from_slice(&padded[..row.len()]);
        }
    })?;
    Ok(out)
}

/// Fills a staging buffer on the GPU and hands its bytes to `take`.
fn copy_out(
    gpu: &Gpu,
    bytes: u64,
    copy: impl FnOnce(&mut wgpu::CommandEncoder, &wgpu::Buffer),
    take: impl FnOnce(&[u8]),
) -> Result<(), Error> {
    let limit = gpu.device().limits().max_buffer_size;
    if bytes > limit {
        return Err(gpu.limit_error("reading back".into(), bytes, "bytes in one buffer", limit));
    }
    let usage = wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ;
    let descriptor = wgpu::BufferDescriptor { label: Some("read-back"), size: bytes, usage, mapped_at_creation: false };
    let staging = gpu.checked(STEP, || {
        let staging = gpu.device().create_buffer(&descriptor);
        let mut encoder = gpu.device().create_command_encoder(&Default::default());
        copy(&mut encoder, &staging);
        gpu.queue().submit([encoder.finish()]);
        staging
    })?;
    wait_mapped(gpu, &staging)?;
    take(&staging.get_mapped_range(..).map_err(failed)?);
    Ok(())
}

/// Waits until the GPU has filled a buffer and it can be read.
fn wait_mapped(gpu: &Gpu, staging: &wgpu::Buffer) -> Result<(), Error> {
    let (sender, receiver) = mpsc::channel();
    let polled = gpu.checked(STEP, || {
        staging.map_async(wgpu::MapMode::Read, .., move |result| {
            // The receiver outlives the wait below; if not, nobody wants to know.
            let _ = sender.send(result);
        });
        gpu.device().poll(wgpu::PollType::wait_indefinitely())
    })?;
    polled.map_err(failed)?;
    receiver.recv().map_err(failed)?.map_err(failed)
}

const STEP: &str = "reading back";

fn failed(error: impl std::fmt::Display) -> Error {
    Error::Device { step: STEP, message: error.to_string() }
}
