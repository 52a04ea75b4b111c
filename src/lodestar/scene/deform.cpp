// SPDX-License-Identifier: Apache-2.0
#include <lodestar/scene/deform.hpp>

#include <bit>
#include <map>

namespace lodestar::scene {
namespace {

constexpr std::uint32_t kDeformCode[] =
#include <lodestar/scene/deform.comp.inc>
    ;
constexpr std::uint32_t kBoundsCode[] =
#include <lodestar/scene/deform_bounds.comp.inc>
    ;

using gpu::Slot;
using gpu::Stage;

constexpr auto kPair = vk::Format::eR32G32Uint;
constexpr auto kRow = vk::Format::eR32G32B32A32Sfloat;

vk::Extent3D groupsOf(std::uint32_t threads) {
    const std::uint32_t groups = gpu::groups(threads, 64), rows = gpu::groups(groups, 32768);
    return {gpu::groups(groups, rows), rows, 1};
}

std::uint32_t number(std::size_t n) {
    return static_cast<std::uint32_t>(n);
}

std::uint32_t deltasOf(const Mesh& mesh) {
    std::uint32_t has = 0;
    for (const MorphTarget& target : mesh.targets)
        has |= (target.position.empty() ? 0 : shared::LS_DELTA_POSITION) |
               (target.normal.empty() ? 0 : shared::LS_DELTA_NORMAL) |
               (target.tangent.empty() ? 0 : shared::LS_DELTA_TANGENT);
    return has;
}

}  // namespace

struct Deform::Packed {
    std::vector<Job> jobs;
    std::vector<glm::vec4> rest, deltas;
    std::vector<glm::uvec2> influences;
    std::size_t joints = 0, targets = 0;  // of all instances

    void add(const Mesh&, Job&);
};

/// What the mesh is made of, once for all instances that show it.
void Deform::Packed::add(const Mesh& mesh, Job& job) {
    shared::DeformParams& p = job.params;
    p.vertexCount = number(mesh.vertices.size());
    p.firstRest = number(rest.size() / 3);
    for (const Vertex& v : mesh.vertices) {
        rest.push_back({v.position, v.tangent.w});
        rest.push_back({v.normal, 0});
        rest.push_back({glm::vec3(v.tangent), 0});
    }
    p.firstInfluence = number(influences.size());
    for (const Influence& i : mesh.influences)
        influences.push_back({i.joint, std::bit_cast<std::uint32_t>(i.weight)});
    p.deltas = deltasOf(mesh);
    p.deltaRows = number(std::popcount(p.deltas));
    job.targets = number(mesh.targets.size());
    job.firstDelta = number(deltas.size());
    for (const MorphTarget& target : mesh.targets)
        for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
            const auto push = [&](std::uint32_t which, const std::vector<glm::vec3>& list) {
                if (p.deltas & which) deltas.push_back({list.empty() ? glm::vec3(0) : list[v], 0});
            };
            push(shared::LS_DELTA_POSITION, target.position);
            push(shared::LS_DELTA_NORMAL, target.normal);
            push(shared::LS_DELTA_TANGENT, target.tangent);
        }
}

Deform::Deform(const gpu::Device& device, const Scene& scene, const std::vector<Part>& parts,
               std::uint32_t first, std::uint32_t count)
    : Deform(
          device,
          [&] {
              Packed packed;
              std::map<std::uint32_t, Job> known;  // of a mesh
              for (const Part& part : parts) {
                  const Instance& instance = scene.instances[part.instance];
                  const auto [mesh, isNew] = known.try_emplace(instance.mesh);
                  if (isNew) packed.add(scene.meshes[instance.mesh], mesh->second);
                  Job job = mesh->second;
                  job.instance = part.instance;
                  job.params.firstVertex = part.firstVertex;
                  if (instance.skin != kNone) {
                      job.params.joints = scene.meshes[instance.mesh].jointsPerVertex;
                      job.params.firstJoint = number(packed.joints);
                      packed.joints += scene.skins[instance.skin].joints.size();
                  }
                  packed.targets += job.targets;
                  packed.jobs.push_back(job);
              }
              return packed;
          }(),
          first, count) {}

Deform::Deform(const gpu::Device& device, Packed&& packed, std::uint32_t first, std::uint32_t count)
    : deform(device, "deform", kDeformCode,
             {Slot::texelBuffer, Slot::texelBuffer, Slot::texelBuffer, Slot::texelBuffer,
              Slot::texelBuffer, Slot::storageBuffer, Slot::storageBuffer},
             sizeof(shared::DeformParams)),
      bounds(device, "deform: bounds", kBoundsCode,
             {Slot::texelBuffer, Slot::texelBuffer, Slot::storageBuffer},
             sizeof(shared::DeformBoundsParams)),
      jobs(std::move(packed.jobs)),
      firstMeshlet(first),
      meshletCount(count),
      rest(gpu::makeTexelBuffer(device, "deform: rest", packed.rest, kRow)),
      influences(gpu::makeTexelBuffer(device, "deform: influences", packed.influences, kPair)),
      deltas(gpu::makeTexelBuffer(device, "deform: morph targets", packed.deltas, kRow)),
      joints(device, "deform: joints", packed.joints * 3 * sizeof(glm::vec4), kRow),
      active(device, "deform: weights", packed.targets * sizeof(glm::uvec2), kPair),
      rec(device) {}

void Deform::upload(const Scene& scene, const Pose& pose) {
    std::vector<glm::vec4> rows;
    std::vector<glm::uvec2> weighted;
    for (Job& job : jobs) {
        const Instance& instance = scene.instances[job.instance];
        if (instance.skin != kNone) {
            const Skin& skin = scene.skins[instance.skin];
            for (std::size_t j = 0; j < skin.joints.size(); ++j) {
                const glm::mat4 m =
                    glm::transpose(pose.worldFromNode[skin.joints[j]] * skin.jointFromBind[j]);
                rows.insert(rows.end(), {m[0], m[1], m[2]});
            }
        }
        job.params.firstActive = number(weighted.size());
        const auto weights = pose.weights.find(instance.weightsNode);
        if (weights != pose.weights.end())
            for (std::uint32_t t = 0; t < job.targets && t < weights->second.size(); ++t)
                if (const float weight = weights->second[t]; weight != 0)
                    weighted.push_back(
                        {job.firstDelta + t * job.params.vertexCount * job.params.deltaRows,
                         std::bit_cast<std::uint32_t>(weight)});
        job.params.activeCount = number(weighted.size()) - job.params.firstActive;
    }
    joints.buffer().upload(rows);
    active.buffer().upload(weighted);
}

gpu::FrameTimes Deform::run(const Scene& scene, const Pose& pose, const Geometry& to) {
    upload(scene, pose);
    rec.begin();
    {
        const auto pass = rec.pass("deform");
        for (const Job& job : jobs)
            rec.dispatch(deform, groupsOf(job.params.vertexCount),
                         {rest, influences, deltas, joints, active, to.vertices.buffer(),
                          to.attributes.buffer()},
                         job.params);
    }
    rec.barrier(Stage::compute, Stage::compute);
    {
        const auto pass = rec.pass("deform: bounds");
        rec.dispatch(bounds, groupsOf(meshletCount),
                     {to.vertices, to.triangles, to.meshlets.buffer()},
                     shared::DeformBoundsParams{firstMeshlet, meshletCount});
    }
    return rec.submit();
}

}  // namespace lodestar::scene
