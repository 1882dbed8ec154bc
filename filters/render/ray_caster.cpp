// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/ray_caster.hpp"

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "scanmill/base/error.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill {

namespace {

/// Items are scaled into the unit ball. There, floats of rays and boxes err by less than 4e-7; Embree's robust
/// traversal adds a few units in the last place.
constexpr double widening = 2e-6;

float below(double value) { return std::nextafter(static_cast<float>(value - widening), -2.0f); }
float above(double value) { return std::nextafter(static_cast<float>(value + widening), 2.0f); }

}  // namespace

RayHit hit_triangle(const Ray& ray, const Vec3& a, const Vec3& b, const Vec3& c) {
    // Signed volumes of the ray's direction with the three edges. The two triangles at an edge compute volumes that
    // differ in sign only, so no ray passes between them.
    const Vec3 oa = a - ray.origin, ob = b - ray.origin, oc = c - ray.origin;
    const double u = ray.direction.dot(oc.cross(ob)), v = ray.direction.dot(oa.cross(oc)),
                 w = ray.direction.dot(ob.cross(oa));
    if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return {};
    // Sums in an order of the corners that does not depend on the triangle: a triangle that is there twice has the same
    // distance twice, also turned over.
    std::array<std::pair<const Vec3*, double>, 3> terms{{{&oa, u}, {&ob, v}, {&oc, w}}};
    std::ranges::sort(terms, [](const auto& one, const auto& other) { return is_lower(*one.first, *other.first); });
    const double sum = terms[0].second + terms[1].second + terms[2].second;
    if (sum == 0) return {};
    RayHit hit;
    hit.weights = {u / sum, v / sum, w / sum};
    Vec3 place = Vec3::Zero();
    for (const auto& [corner, volume] : terms) place += volume / sum * *corner;
    hit.distance = ray.direction.dot(place);
    if (!(hit.distance >= ray.from)) return {};
    hit.item = 0;
    return hit;
}

RayHit hit_disc(const Ray& ray, const Disc& disc) {
    const bool faces_ray = disc.normal == Vec3::Zero();
    const Vec3 offset = disc.centre - ray.origin;
    const double slope = faces_ray ? 1 : disc.normal.dot(ray.direction);
    if (slope == 0) return {};
    const double distance = (faces_ray ? ray.direction : disc.normal).dot(offset) / slope;
    if (!(distance >= ray.from) || !((distance * ray.direction - offset).squaredNorm() <= disc.radius * disc.radius))
        return {};
    RayHit hit;
    hit.item = 0;
    hit.distance = distance;
    return hit;
}

struct RayCaster::Scene {
    std::span<const Vec3> positions;
    std::span<const Triangle> triangles;
    std::span<const Disc> discs;
    Vec3 centre;
    double radius = 0;
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;

    ~Scene() {
        if (scene) rtcReleaseScene(scene);
        if (device) rtcReleaseDevice(device);
    }

    std::size_t size() const { return triangles.size() + discs.size(); }
    BoundingBox box_of(std::size_t item) const {
        BoundingBox box;
        if (item < triangles.size()) {
            for (const u32 vertex : triangles[item]) box.add(positions[vertex]);
        } else {
            const Disc& disc = discs[item - triangles.size()];
            box = {disc.centre - Vec3::Constant(disc.radius), disc.centre + Vec3::Constant(disc.radius)};
        }
        return box;
    }
    RayHit hit(std::size_t item, const Ray& ray) const {
        RayHit found;
        if (item < triangles.size()) {
            const Triangle& corners = triangles[item];
            found = hit_triangle(ray, positions[corners[0]], positions[corners[1]], positions[corners[2]]);
        } else {
            found = hit_disc(ray, discs[item - triangles.size()]);
        }
        if (found.found()) found.item = static_cast<u32>(item);
        return found;
    }

    /// The ray in the unit ball's coordinates, from where it enters the ball. Returns the distance to that place, or
    /// infinity if the ray misses the ball.
    double enter(const Ray& ray, RTCRay& entering) const {
        const Vec3 from_centre = ray.origin - centre;
        const double along = -ray.direction.dot(from_centre);
        const double squared_miss = (from_centre + along * ray.direction).squaredNorm();
        const double reach = 1.01 * radius;  // rounding must not make a ray miss the ball
        if (!(squared_miss <= reach * reach)) return std::numeric_limits<double>::infinity();
        const double start = std::max(ray.from, along - 1.5 * radius);
        const Vec3 entry = (from_centre + start * ray.direction) / radius;
        entering.org_x = static_cast<float>(entry.x());
        entering.org_y = static_cast<float>(entry.y());
        entering.org_z = static_cast<float>(entry.z());
        entering.dir_x = static_cast<float>(ray.direction.x());
        entering.dir_y = static_cast<float>(ray.direction.y());
        entering.dir_z = static_cast<float>(ray.direction.z());
        entering.tnear = 0;
        entering.tfar = std::numeric_limits<float>::infinity();
        entering.time = 0;
        entering.mask = ~0u;
        entering.id = 0;
        entering.flags = 0;
        return start;
    }
};

namespace {

/// The state of one search, which Embree hands to the callbacks.
struct Search : RTCIntersectContext {
    const Ray* ray;
    RayHit best;
    double start;  ///< distance from the ray's origin to the entry into the ball
    double until;
};

}  // namespace

RayCaster::RayCaster(std::span<const Vec3> positions, std::span<const Triangle> triangles, std::span<const Disc> discs,
                     unsigned threads, const char* instruction_set)
    : scene_(std::make_unique<Scene>()) {
    Scene& scene = *scene_;
    scene.positions = positions;
    scene.triangles = triangles;
    scene.discs = discs;
    if (scene.size() == 0)
        throw Error("there is nothing to draw: the scene has neither triangles nor points")
            .hint("give a mesh or points");
    if (scene.size() >= RayHit::none)
        throw Error("a scene has at most {} triangles and points; found {}", RayHit::none - 1, scene.size())
            .hint("decimate the mesh, or thin the points");
    BoundingBox box;
    for (const Triangle& corners : triangles)
        for (const u32 vertex : corners) box.add(positions[vertex]);
    for (std::size_t i = triangles.size(); i < scene.size(); ++i) {
        const BoundingBox disc = scene.box_of(i);
        box.add(disc.low);
        box.add(disc.high);
    }
    scene.centre = (box.low + box.high) / 2;
    scene.radius = box.diagonal() / 2;
    if (!(scene.radius > 0)) scene.radius = 1;

    // Without a number of threads, Embree sets no limit for the whole process; the arena that commits the scene has
    // one.
    const std::string configuration = fmt::format("isa={}", instruction_set);
    scene.device = rtcNewDevice(configuration.c_str());
    if (!scene.device)
        throw Error("Embree does not start: error {}", static_cast<int>(rtcGetDeviceError(nullptr)))
            .hint("the package libembree3-3 may be damaged; install it again");
    scene.scene = rtcNewScene(scene.device);
    rtcSetSceneFlags(scene.scene, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = rtcNewGeometry(scene.device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(scene.size()));
    rtcSetGeometryUserData(geometry, &scene);
    rtcSetGeometryBoundsFunction(
        geometry,
        [](const RTCBoundsFunctionArguments* arguments) {
            const Scene& items = *static_cast<const Scene*>(arguments->geometryUserPtr);
            const BoundingBox own = items.box_of(arguments->primID);
            const Vec3 low = (own.low - items.centre) / items.radius, high = (own.high - items.centre) / items.radius;
            RTCBounds& bounds = *arguments->bounds_o;
            bounds.lower_x = below(low.x()), bounds.upper_x = above(high.x());
            bounds.lower_y = below(low.y()), bounds.upper_y = above(high.y());
            bounds.lower_z = below(low.z()), bounds.upper_z = above(high.z());
        },
        nullptr);
    rtcSetGeometryIntersectFunction(geometry, [](const RTCIntersectFunctionNArguments* arguments) {
        if (!arguments->valid[0]) return;
        const Scene& items = *static_cast<const Scene*>(arguments->geometryUserPtr);
        Search& search = *static_cast<Search*>(arguments->context);
        const RayHit hit = items.hit(arguments->primID, *search.ray);
        if (!hit.found() || hit.distance > search.best.distance) return;
        if (hit.distance == search.best.distance && hit.item > search.best.item) return;
        search.best = hit;
        reinterpret_cast<RTCRayHit*>(arguments->rayhit)->ray.tfar = above((hit.distance - search.start) / items.radius);
    });
    rtcSetGeometryOccludedFunction(geometry, [](const RTCOccludedFunctionNArguments* arguments) {
        if (!arguments->valid[0]) return;
        const Scene& items = *static_cast<const Scene*>(arguments->geometryUserPtr);
        const Search& search = *static_cast<const Search*>(arguments->context);
        const RayHit hit = items.hit(arguments->primID, *search.ray);
        if (hit.found() && hit.distance < search.until)
            reinterpret_cast<RTCRay*>(arguments->ray)->tfar = -std::numeric_limits<float>::infinity();
    });
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene.scene, geometry);
    rtcReleaseGeometry(geometry);
    within_thread_budget(threads, [&] { rtcCommitScene(scene.scene); });
    if (const RTCError error = rtcGetDeviceError(scene.device); error != RTC_ERROR_NONE) {
        if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
        throw Error("Embree cannot build the scene: error {}", static_cast<int>(error))
            .hint("this is a fault of the program; please report it with the scene");
    }
}

RayCaster::~RayCaster() = default;

RayHit RayCaster::first(const Ray& ray) const {
    Search search;
    rtcInitIntersectContext(&search);
    RTCRayHit entering;
    search.start = scene_->enter(ray, entering.ray);
    if (std::isinf(search.start)) return {};
    search.ray = &ray;
    entering.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    entering.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_->scene, &search, &entering);
    return search.best;
}

bool RayCaster::is_blocked(const Ray& ray, double until) const {
    Search search;
    rtcInitIntersectContext(&search);
    RTCRay entering;
    search.start = scene_->enter(ray, entering);
    if (std::isinf(search.start)) return false;
    search.ray = &ray;
    search.until = until;
    entering.tfar = std::max(0.0f, above((until - search.start) / scene_->radius));
    rtcOccluded1(scene_->scene, &search, &entering);
    return entering.tfar < 0;
}

bool RayCaster::faces(u32 item, const Ray& ray) const {
    if (item >= triangles()) return scene_->discs[item - triangles()].normal.dot(ray.direction) <= 0;
    return area_vector(scene_->positions, scene_->triangles[item]).dot(ray.direction) <= 0;
}

std::size_t RayCaster::triangles() const { return scene_->triangles.size(); }
const Vec3& RayCaster::centre() const { return scene_->centre; }
double RayCaster::radius() const { return scene_->radius; }

}  // namespace scanmill
