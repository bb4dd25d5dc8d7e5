//! As much of Embree 3 as the comparison needs. Declarations by the headers of version 3.13.

use anyhow::{Result, bail};
use std::ffi::{c_int, c_uint, c_void};
use std::ptr;

/// Rays of a packet.
pub const LANES: usize = 16;

const INVALID_ID: c_uint = c_uint::MAX;
const BUILD_QUALITY_HIGH: c_int = 2;
const BUFFER_INDEX: c_int = 0;
const BUFFER_VERTEX: c_int = 1;
const FORMAT_UINT3: c_int = 0x5003;
const FORMAT_UINT4: c_int = 0x5004;
const FORMAT_FLOAT3: c_int = 0x9003;
const CONTEXT_COHERENT: c_int = 1;

/// `RTCIntersectContext`, of a library for one level of instances.
#[repr(C)]
struct Context {
    flags: c_int,
    filter: *const c_void,
    instance: [c_uint; 1],
}

/// `RTCRayHit16`: rays and what they hit, lane by lane.
#[repr(C, align(64))]
pub struct Packet {
    pub origin: [[f32; LANES]; 3],
    near: [f32; LANES],
    pub direction: [[f32; LANES]; 3],
    time: [f32; LANES],
    /// Distance to the hit, in lengths of the direction.
    pub far: [f32; LANES],
    mask: [c_uint; LANES],
    id: [c_uint; LANES],
    flags: [c_uint; LANES],
    normal: [[f32; LANES]; 3],
    uv: [[f32; LANES]; 2],
    primitive: [c_uint; LANES],
    geometry: [c_uint; LANES],
    instance: [[c_uint; LANES]; 1],
}

impl Packet {
    /// Rays from `origin` in these directions.
    pub fn new(origin: [f32; 3], direction: [[f32; LANES]; 3]) -> Self {
        Self {
            origin: origin.map(|coordinate| [coordinate; LANES]),
            near: [0.0; LANES],
            direction,
            time: [0.0; LANES],
            far: [f32::INFINITY; LANES],
            mask: [c_uint::MAX; LANES],
            id: [0; LANES],
            flags: [0; LANES],
            normal: [[0.0; LANES]; 3],
            uv: [[0.0; LANES]; 2],
            primitive: [INVALID_ID; LANES],
            geometry: [INVALID_ID; LANES],
            instance: [[INVALID_ID; LANES]; 1],
        }
    }

    /// Whether the ray of a lane hit something.
    pub fn is_hit(&self, lane: usize) -> bool {
        self.geometry[lane] != INVALID_ID
    }
}

#[allow(non_snake_case, reason = "the names of the library")]
unsafe extern "C" {
    fn rtcNewDevice(config: *const u8) -> *mut c_void;
    fn rtcReleaseDevice(device: *mut c_void);
    fn rtcGetDeviceError(device: *mut c_void) -> c_int;
    fn rtcNewScene(device: *mut c_void) -> *mut c_void;
    fn rtcReleaseScene(scene: *mut c_void);
    fn rtcSetSceneBuildQuality(scene: *mut c_void, quality: c_int);
    fn rtcCommitScene(scene: *mut c_void);
    fn rtcNewGeometry(device: *mut c_void, kind: c_int) -> *mut c_void;
    fn rtcReleaseGeometry(geometry: *mut c_void);
    fn rtcCommitGeometry(geometry: *mut c_void);
    fn rtcAttachGeometry(scene: *mut c_void, geometry: *mut c_void) -> c_uint;
    fn rtcSetNewGeometryBuffer(
        geometry: *mut c_void,
        kind: c_int,
        slot: c_uint,
        format: c_int,
        stride: usize,
        count: usize,
    ) -> *mut c_void;
    fn rtcIntersect16(valid: *const c_int, scene: *mut c_void, context: *mut Context, packet: *mut Packet);
}

/// Faces that all have `N` corners.
pub struct Faces<const N: usize> {
    pub vertices: Vec<[f32; 3]>,
    pub corners: Vec<[u32; N]>,
}

/// A scene of one list of faces, made ready for rays.
pub struct Scene {
    device: *mut c_void,
    scene: *mut c_void,
}

impl Scene {
    pub fn of_triangles(faces: &Faces<3>) -> Result<Self> {
        Self::new(faces, 0, FORMAT_UINT3)
    }

    pub fn of_quads(faces: &Faces<4>) -> Result<Self> {
        Self::new(faces, 1, FORMAT_UINT4)
    }

    fn new<const N: usize>(faces: &Faces<N>, kind: c_int, format: c_int) -> Result<Self> {
        if faces.corners.iter().flatten().any(|&corner| corner as usize >= faces.vertices.len()) {
            bail!("a face has a corner that is no vertex");
        }
        // SAFETY: every handle comes from the call before it and is used while it is alive; buffers are filled as long
        // as they were asked for; the layouts are those of the headers.
        unsafe {
            let device = rtcNewDevice(ptr::null());
            if device.is_null() {
                bail!("Embree cannot be started");
            }
            let scene = rtcNewScene(device);
            let this = Self { device, scene };
            rtcSetSceneBuildQuality(scene, BUILD_QUALITY_HIGH);
            let geometry = rtcNewGeometry(device, kind);
            fill(geometry, BUFFER_VERTEX, FORMAT_FLOAT3, &faces.vertices)?;
            fill(geometry, BUFFER_INDEX, format, &faces.corners)?;
            rtcCommitGeometry(geometry);
            rtcAttachGeometry(scene, geometry);
            rtcReleaseGeometry(geometry);
            rtcCommitScene(scene);
            match rtcGetDeviceError(device) {
                0 => Ok(this),
                code => bail!("Embree fails with code {code}"),
            }
        }
    }

    /// Finds what the rays of a packet hit. They are taken to be coherent.
    pub fn intersect(&self, packet: &mut Packet) {
        #[repr(C, align(64))]
        struct Valid([c_int; LANES]);
        let valid = Valid([-1; LANES]);
        let mut context = Context { flags: CONTEXT_COHERENT, filter: ptr::null(), instance: [INVALID_ID] };
        // SAFETY: the scene is committed, and all arguments live and are aligned as the library expects.
        unsafe { rtcIntersect16(valid.0.as_ptr(), self.scene, &raw mut context, packet) }
    }
}

impl Drop for Scene {
    fn drop(&mut self) {
        // SAFETY: both are alive, and nothing else refers to them.
        unsafe {
            rtcReleaseScene(self.scene);
            rtcReleaseDevice(self.device);
        }
    }
}

/// # Safety
/// `geometry` is alive, and `format` is that of `T`.
unsafe fn fill<T: Copy>(geometry: *mut c_void, kind: c_int, format: c_int, elements: &[T]) -> Result<()> {
    // SAFETY: by the caller; the buffer is as long as `elements`.
    unsafe {
        let buffer = rtcSetNewGeometryBuffer(geometry, kind, 0, format, size_of::<T>(), elements.len());
        if buffer.is_null() {
            bail!("Embree has no memory for {} elements", elements.len());
        }
        ptr::copy_nonoverlapping(elements.as_ptr(), buffer.cast(), elements.len());
    }
    Ok(())
}
