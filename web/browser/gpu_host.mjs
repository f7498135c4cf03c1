// A host of the GPU path in a browser: runs a captured dispatch (crates/gpu/src/capture.rs) by WebGPU, and compares the
// texels with the CPU's.

const bytesOf = (hex) => {
  const bytes = new Uint8Array(hex.length / 2);
  for (let k = 0; k < bytes.length; k += 1) bytes[k] = parseInt(hex.substr(2 * k, 2), 16);
  return bytes;
};

const BYTES = { r8unorm: 1, rg8unorm: 2, r32float: 4, rgba32float: 16 };
const MIN_BYTES = 256;

export async function run(capture) {
  if (!navigator.gpu) return { reason: "there is no WebGPU" };
  const adapter = await navigator.gpu.requestAdapter();
  if (!adapter) return { reason: "there is no adapter" };
  const device = await adapter.requestDevice();
  device.pushErrorScope("validation");
  const module = device.createShaderModule({ code: capture.shader });
  const complaints = (await module.getCompilationInfo()).messages.filter((m) => m.type === "error").map((m) => m.message);
  if (complaints.length > 0) return { reason: complaints.join("\n") };

  const visibility = GPUShaderStage.COMPUTE;
  const buffer = (type) => ({ buffer: { type } });
  const texture = { texture: { sampleType: "unfilterable-float", viewDimension: "2d-array" } };
  const entries = [
    { binding: 0, visibility, ...buffer("uniform") },
    ...[1, 2, 3, 4].map((binding) => ({ binding, visibility, ...buffer("read-only-storage") })),
    { binding: 5, visibility, ...buffer("storage") },
    { binding: 6, visibility, sampler: { type: "non-filtering" } },
    ...capture.textures.map(({ binding }) => ({ binding, visibility, ...texture })),
  ];
  const layout = device.createBindGroupLayout({ entries });
  const pipeline = await device.createComputePipelineAsync({
    layout: device.createPipelineLayout({ bindGroupLayouts: [layout] }),
    compute: { module, entryPoint: "march" },
  });

  const made = (bytes, usage) => {
    const own = device.createBuffer({ size: Math.max(MIN_BYTES, Math.ceil(bytes.length / 16) * 16), usage });
    device.queue.writeBuffer(own, 0, bytes);
    return { buffer: own };
  };
  const { UNIFORM, STORAGE, COPY_DST, COPY_SRC, MAP_READ } = GPUBufferUsage;
  const state = device.createBuffer({ size: capture.state_bytes, usage: STORAGE | COPY_SRC });
  const resources = capture.buffers.map((hex, k) => made(bytesOf(hex), (k === 0 ? UNIFORM : STORAGE) | COPY_DST));
  const bound = [
    ...resources.map((resource, binding) => ({ binding, resource })),
    { binding: 5, resource: { buffer: state } },
    { binding: 6, resource: device.createSampler() },
    ...capture.textures.map(({ binding, format, size: [width, height, layers], bytes }) => {
      const own = device.createTexture({
        size: [width, height, layers],
        format,
        usage: GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_DST,
      });
      const rows = { bytesPerRow: width * BYTES[format], rowsPerImage: height };
      device.queue.writeTexture({ texture: own }, bytesOf(bytes), rows, [width, height, layers]);
      return { binding, resource: own.createView({ dimension: "2d-array" }) };
    }),
  ];
  const encoder = device.createCommandEncoder();
  const pass = encoder.beginComputePass();
  pass.setPipeline(pipeline);
  pass.setBindGroup(0, device.createBindGroup({ layout, entries: bound }));
  pass.dispatchWorkgroups(capture.groups[0], capture.groups[1]);
  pass.end();
  const read = device.createBuffer({ size: capture.state_bytes, usage: MAP_READ | COPY_DST });
  encoder.copyBufferToBuffer(state, 0, read, 0, capture.state_bytes);
  device.queue.submit([encoder.finish()]);
  await read.mapAsync(GPUMapMode.READ);
  const got = new Float32Array(read.getMappedRange().slice(0));
  const error = await device.popErrorScope();
  if (error) return { reason: error.message };

  // The state of a projection is a value and a length; the value counts only where the length is not 0. Colours may be
  // followed by the entry of the ray.
  const texels = capture.texels;
  const perRay = got.length / (texels.length / 4);
  const isValue = capture.name === "maximum";
  let [largest, beyond, seen] = [0, 0, 0];
  for (let k = 0, own = 0; k < texels.length; k += 4, own += perRay) {
    let apart = 0;
    if (isValue) {
      apart = texels[k + 3] > 0 ? Math.abs(got[own] - texels[k]) : 0;
    } else {
      for (let c = 0; c < 4; c += 1) apart = Math.max(apart, 255 * Math.abs(got[own + c] - texels[k + c]));
    }
    seen += texels[k + 3] > 0.05 ? 1 : 0;
    largest = Math.max(largest, apart);
    beyond += apart > 1 ? 1 : 0;
  }
  const { vendor, architecture } = adapter.info;
  return { reason: null, adapter: `${vendor} ${architecture}`, largest, beyond, seen };
}
