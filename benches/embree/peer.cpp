// Embree's side of `repro -- prt/embree`: traces the rays that the other side wrote, on this thread, and says how long it took.
//
// Argument: a file of little-endian numbers: the counts of vertices, triangles, points and directions (u32 each; directions are a multiple
// of 64); vertices [V,3] f32; triangles [T,3] u32; points [P,3] f32; directions [D,3] f32; for each point a bit for each direction to
// trace [P, D/64] u64. Requests come on stdin, one a line: `MODE FILE`; the answer is the seconds of CPU time that tracing all rays
// took, and FILE holds what was found (`-`: nothing is written).
//
// Modes and their answers:
//   occluded1, occluded8, occluded16, stream   any hit: a bit for each direction [P, D/64] u64
//   intersect1, intersect1-occluded            nearest hit of all rays; of those that the last any-hit mode found occluded:
//                                              triangle (u32, all ones: none) and distance (f32) for each direction [P, D]
//   intersect1-scattered                       nearest hit of SCATTERED single rays, each from another point in another direction
//
// The scene is RTC_SCENE_FLAG_ROBUST with RTC_BUILD_QUALITY_HIGH; rays are declared coherent, but for the scattered ones.

#include <embree3/rtcore.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <iostream>
#include <limits>
#include <string>
#include <vector>

constexpr uint32_t SCATTERED = 2000000;

struct Vec3 { float x, y, z; };
struct Found { uint32_t triangle; float distance; };

struct Workload {
    std::vector<Vec3> vertices, points, directions;
    std::vector<uint32_t> triangles;
    std::vector<uint64_t> rays;
    size_t words() const { return directions.size() / 64; }
};

template <class T>
std::vector<T> read(std::ifstream& file, size_t count) {
    std::vector<T> values(count);
    file.read(reinterpret_cast<char*>(values.data()), count * sizeof(T));
    if (!file) { std::cerr << "the workload ends early\n"; std::exit(1); }
    return values;
}

Workload read_workload(const char* path) {
    std::ifstream file(path, std::ios::binary);
    auto counts = read<uint32_t>(file, 4);
    Workload work;
    work.vertices = read<Vec3>(file, counts[0]);
    work.triangles = read<uint32_t>(file, 3 * size_t(counts[1]));
    work.points = read<Vec3>(file, counts[2]);
    work.directions = read<Vec3>(file, counts[3]);
    work.rays = read<uint64_t>(file, counts[2] * work.words());
    return work;
}

RTCScene build(RTCDevice device, const Workload& work) {
    RTCScene scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vec3), work.vertices.size());
    std::copy(work.vertices.begin(), work.vertices.end(), static_cast<Vec3*>(vertices));
    void* triangles = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, work.triangles.size() / 3);
    std::copy(work.triangles.begin(), work.triangles.end(), static_cast<uint32_t*>(triangles));
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene);
    return scene;
}

double cpu_seconds() {
    timespec time;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return time.tv_sec + 1e-9 * time.tv_nsec;
}

RTCIntersectContext context(RTCIntersectContextFlags flags) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = flags;
    return context;
}

RTCRay ray(Vec3 origin, Vec3 direction) {
    RTCRay ray;
    ray.org_x = origin.x, ray.org_y = origin.y, ray.org_z = origin.z;
    ray.dir_x = direction.x, ray.dir_y = direction.y, ray.dir_z = direction.z;
    ray.tnear = 0, ray.tfar = std::numeric_limits<float>::infinity();
    ray.time = 0, ray.mask = ~0u, ray.id = 0, ray.flags = 0;
    return ray;
}

struct Tracer {
    RTCScene scene;
    const Workload& work;
    // Of the last any-hit mode.
    std::vector<uint64_t> occluded;
    std::vector<Found> found;
    // Numbers of the directions to trace from one point.
    std::vector<uint32_t> active;

    void take(size_t point, const std::vector<uint64_t>& rays) {
        active.clear();
        for (size_t word = 0; word < work.words(); ++word)
            for (uint64_t rest = rays[point * work.words() + word]; rest; rest &= rest - 1)
                active.push_back(64 * word + __builtin_ctzll(rest));
    }

    void mark(size_t point, uint32_t direction, float tfar) {
        uint64_t bit = tfar < 0;
        occluded[point * work.words() + direction / 64] |= bit << direction % 64;
    }

    void occluded1(size_t point) {
        auto coherent = context(RTC_INTERSECT_CONTEXT_FLAG_COHERENT);
        for (uint32_t direction : active) {
            RTCRay one = ray(work.points[point], work.directions[direction]);
            rtcOccluded1(scene, &coherent, &one);
            mark(point, direction, one.tfar);
        }
    }

    template <class Rays, size_t N, class Trace>
    void packets(size_t point, Trace trace) {
        auto coherent = context(RTC_INTERSECT_CONTEXT_FLAG_COHERENT);
        for (size_t first = 0; first < active.size(); first += N) {
            alignas(64) Rays rays;
            alignas(64) int valid[N];
            for (size_t lane = 0; lane < N; ++lane) {
                bool is_valid = first + lane < active.size();
                valid[lane] = is_valid ? -1 : 0;
                RTCRay one = ray(work.points[point], work.directions[active[is_valid ? first + lane : first]]);
                rays.org_x[lane] = one.org_x, rays.org_y[lane] = one.org_y, rays.org_z[lane] = one.org_z;
                rays.dir_x[lane] = one.dir_x, rays.dir_y[lane] = one.dir_y, rays.dir_z[lane] = one.dir_z;
                rays.tnear[lane] = one.tnear, rays.tfar[lane] = one.tfar, rays.time[lane] = 0;
                rays.mask[lane] = one.mask, rays.id[lane] = 0, rays.flags[lane] = 0;
            }
            trace(valid, scene, &coherent, &rays);
            for (size_t lane = 0; lane < N && first + lane < active.size(); ++lane)
                mark(point, active[first + lane], rays.tfar[lane]);
        }
    }

    void stream(size_t point) {
        auto coherent = context(RTC_INTERSECT_CONTEXT_FLAG_COHERENT);
        static std::vector<RTCRay> rays;
        rays.clear();
        for (uint32_t direction : active) rays.push_back(ray(work.points[point], work.directions[direction]));
        rtcOccluded1M(scene, &coherent, rays.data(), rays.size(), sizeof(RTCRay));
        for (size_t i = 0; i < active.size(); ++i) mark(point, active[i], rays[i].tfar);
    }

    Found closest(size_t point, uint32_t direction, RTCIntersectContext* context) {
        RTCRayHit one;
        one.ray = ray(work.points[point], work.directions[direction]);
        one.hit.geomID = one.hit.primID = RTC_INVALID_GEOMETRY_ID;
        one.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(scene, context, &one);
        return {one.hit.primID, one.ray.tfar};
    }

    void intersect1(size_t point) {
        auto coherent = context(RTC_INTERSECT_CONTEXT_FLAG_COHERENT);
        for (uint32_t direction : active) found[point * work.directions.size() + direction] = closest(point, direction, &coherent);
    }

    void scattered() {
        auto incoherent = context(RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
        for (uint64_t i = 0; i < SCATTERED; ++i)
            found[i] = closest(i * 7919 % work.points.size(), i * 1048583 % work.directions.size(), &incoherent);
    }

    double run(const std::string& mode) {
        bool is_any_hit = mode.rfind("intersect1", 0) != 0;
        const auto rays = mode == "intersect1-occluded" ? occluded : work.rays;
        if (is_any_hit) occluded.assign(work.rays.size(), 0);
        else found.assign(mode == "intersect1-scattered" ? SCATTERED : work.points.size() * work.directions.size(), {~0u, 0});
        double start = cpu_seconds();
        if (mode == "intersect1-scattered") scattered();
        else for (size_t point = 0; point < work.points.size(); ++point) {
            take(point, rays);
            if (mode == "occluded1") occluded1(point);
            else if (mode == "occluded8") packets<RTCRay8, 8>(point, rtcOccluded8);
            else if (mode == "occluded16") packets<RTCRay16, 16>(point, rtcOccluded16);
            else if (mode == "stream") stream(point);
            else if (!is_any_hit) intersect1(point);
            else { std::cerr << "there is no mode " << mode << "\n"; std::exit(1); }
        }
        return cpu_seconds() - start;
    }

    void save(const std::string& mode, const std::string& path) {
        std::ofstream file(path, std::ios::binary);
        if (mode.rfind("intersect1", 0) == 0) file.write(reinterpret_cast<char*>(found.data()), found.size() * sizeof(Found));
        else file.write(reinterpret_cast<char*>(occluded.data()), occluded.size() * sizeof(uint64_t));
    }
};

int main(int, char** arguments) {
    Workload work = read_workload(arguments[1]);
    RTCDevice device = rtcNewDevice("threads=1,set_affinity=0");
    std::cout << "Embree " << RTC_VERSION_STRING << std::endl;
    Tracer tracer{build(device, work), work, {}, {}, {}};
    std::string mode, path;
    while (std::cin >> mode >> path) {
        double seconds = tracer.run(mode);
        if (path != "-") tracer.save(mode, path);
        std::cout << seconds << std::endl;
    }
}
