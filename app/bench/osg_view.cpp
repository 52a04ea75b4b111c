// SPDX-License-Identifier: Apache-2.0
#include "app/bench/osg_view.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numeric>

#include <osg/Geode>
#include <osg/Geometry>
#include <osg/LOD>
#include <osg/LightModel>
#include <osg/Material>
#include <osg/MatrixTransform>
#include <osg/Stats>
#include <osgViewer/Viewer>

namespace lodestar::app {
namespace {

using scene::Mesh;
using scene::MeshLods;

/// The levels of one mesh, which share their vertices, and the sphere about it.
struct Levels {
    std::vector<osg::ref_ptr<osg::Geometry>> geometry;
    std::vector<float> errors;
    glm::vec3 centre{0};
    float radius = 0;
};

osg::Vec3 vec(glm::vec3 v) {
    return {v.x, v.y, v.z};
}

Levels levelsOf(const Mesh& mesh, const scene::Material& material, const MeshLods& chain) {
    osg::ref_ptr<osg::Vec3Array> positions = new osg::Vec3Array, normals = new osg::Vec3Array;
    osg::ref_ptr<osg::Vec4Array> colors = new osg::Vec4Array;
    Levels levels{.geometry = {}, .errors = {}, .centre = mesh.bounds.centre()};
    for (const scene::Vertex& v : mesh.vertices) {
        positions->push_back(vec(v.position));
        normals->push_back(vec(v.normal));
        const glm::vec4 c = glm::pow(v.color * material.baseColor, glm::vec4(1 / 2.2f));
        colors->push_back({c.r, c.g, c.b, 1});
        levels.radius = std::max(levels.radius, glm::distance(levels.centre, v.position));
    }
    for (const scene::MeshLod& lod : chain.levels) {
        osg::ref_ptr<osg::DrawElementsUInt> indices = new osg::DrawElementsUInt(GL_TRIANGLES);
        for (const scene::Meshlet& m : lod.meshlets.meshlets)
            for (std::uint32_t i = 0; i < m.triangleCount; ++i) {
                const std::uint32_t t = lod.meshlets.triangles[m.triangleOffset + i];
                for (const int shift : {0, 8, 16})
                    indices->push_back(lod.meshlets.vertices[m.vertexOffset + (t >> shift & 255)]);
            }
        osg::ref_ptr<osg::Geometry> geometry = new osg::Geometry;
        geometry->setUseDisplayList(false);
        geometry->setUseVertexBufferObjects(true);
        geometry->setVertexArray(positions);
        geometry->setNormalArray(normals, osg::Array::BIND_PER_VERTEX);
        geometry->setColorArray(colors, osg::Array::BIND_PER_VERTEX);
        geometry->addPrimitiveSet(indices);
        levels.geometry.push_back(geometry);
        levels.errors.push_back(lod.error);
    }
    return levels;
}

/// Level i from where its error is allowed, seen from the nearest point of the instance's sphere.
osg::ref_ptr<osg::Node> instanceOf(const Levels& levels, const glm::mat4& worldFromObject,
                                   float pixelsPerUnit) {
    osg::ref_ptr<osg::LOD> lod = new osg::LOD;
    lod->setCenterMode(osg::LOD::USER_DEFINED_CENTER);
    lod->setCenter(vec(levels.centre));
    lod->setRadius(levels.radius);
    // osg::LOD measures in the object's space, where an error is as many pixels as in the world's.
    const auto begin = [&](std::size_t i) {
        if (i == 0) return 0.0f;
        if (i >= levels.errors.size() || pixelsPerUnit == 0)
            return std::numeric_limits<float>::max();
        return levels.errors[i] * pixelsPerUnit + levels.radius;
    };
    for (std::size_t i = 0; i < levels.geometry.size(); ++i)
        if (begin(i) < begin(i + 1)) lod->addChild(levels.geometry[i], begin(i), begin(i + 1));
    const float* m = &worldFromObject[0][0];  // both store a matrix so that its last four are where
    osg::ref_ptr<osg::MatrixTransform> at = new osg::MatrixTransform(osg::Matrixf(m));
    at->addChild(lod);
    return at;
}

/// Eight instances a leaf, split at the median of the longest axis: what OpenSceneGraph culls best.
osg::ref_ptr<osg::Group> tree(std::vector<std::pair<glm::vec3, osg::ref_ptr<osg::Node>>>& nodes,
                              std::size_t begin, std::size_t end) {
    osg::ref_ptr<osg::Group> group = new osg::Group;
    if (end - begin <= 8) {
        for (std::size_t i = begin; i < end; ++i) group->addChild(nodes[i].second);
        return group;
    }
    scene::Bounds box;
    for (std::size_t i = begin; i < end; ++i) box.add(nodes[i].first);
    const glm::vec3 extent = box.upper - box.lower;
    const int axis =
        extent.x > extent.y ? (extent.x > extent.z ? 0 : 2) : (extent.y > extent.z ? 1 : 2);
    const std::size_t middle = (begin + end) / 2;
    std::nth_element(
        nodes.begin() + long(begin), nodes.begin() + long(middle), nodes.begin() + long(end),
        [axis](const auto& a, const auto& b) { return a.first[axis] < b.first[axis]; });
    group->addChild(tree(nodes, begin, middle));
    group->addChild(tree(nodes, middle, end));
    return group;
}

/// Waits for OpenGL at the end of a frame, and keeps what was asked for.
struct Finish : osg::Camera::DrawCallback {
    mutable bool read = false;
    mutable osg::ref_ptr<osg::Image> image = new osg::Image;
    mutable std::string renderer;
    int width = 0, height = 0;

    void operator()(osg::RenderInfo&) const override {
        if (renderer.empty())
            if (const auto* name = glGetString(GL_RENDERER))
                renderer = reinterpret_cast<const char*>(name);
        if (read) image->readPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE);
        glFinish();
    }
};

}  // namespace

struct OsgView::Parts {
    osgViewer::Viewer viewer;
    osg::ref_ptr<Finish> finish = new Finish;
    Settings settings;
};

OsgView::OsgView(std::unique_ptr<Parts> p) : parts(std::move(p)) {}
OsgView::~OsgView() = default;
OsgView::OsgView(OsgView&&) noexcept = default;

Result<OsgView> OsgView::open(const scene::Scene& scene, const std::vector<MeshLods>& chains,
                              const scene::Camera& camera, const Settings& settings) {
    if (std::getenv("DISPLAY") == nullptr)
        return fail("OpenSceneGraph needs an X display: run this under xvfb-run");
    auto parts = std::make_unique<Parts>();
    parts->settings = settings;
    osg::ref_ptr<osg::GraphicsContext::Traits> traits = new osg::GraphicsContext::Traits;
    traits->readDISPLAY();
    traits->width = settings.width;
    traits->height = settings.height;
    traits->depth = 24;
    traits->pbuffer = true;
    osg::ref_ptr<osg::GraphicsContext> context =
        osg::GraphicsContext::createGraphicsContext(traits);
    if (!context || !context->valid())
        return fail("OpenSceneGraph finds no off-screen OpenGL on the X display");

    std::vector<Levels> meshes;
    for (std::size_t i = 0; i < scene.meshes.size(); ++i)
        meshes.push_back(
            levelsOf(scene.meshes[i], scene.materials[scene.meshes[i].material], chains.at(i)));
    const float perUnit = float(settings.height) / 2 / std::tan(camera.verticalFov / 2);
    const std::vector<glm::mat4> worldFromNodes = worldFromNode(scene);
    std::vector<std::pair<glm::vec3, osg::ref_ptr<osg::Node>>> nodes;
    for (const scene::Instance& instance : scene.instances) {
        const Levels& levels = meshes[instance.mesh];
        const glm::mat4 m = worldFromNodes[instance.node] * instance.nodeFromObject;
        nodes.emplace_back(
            glm::vec3(m * glm::vec4(levels.centre, 1)),
            instanceOf(levels, m, settings.errorPx > 0 ? perUnit / settings.errorPx : 0));
    }
    osg::ref_ptr<osg::Group> root = tree(nodes, 0, nodes.size());
    osg::StateSet* state = root->getOrCreateStateSet();
    osg::ref_ptr<osg::Material> material = new osg::Material;
    material->setColorMode(osg::Material::AMBIENT_AND_DIFFUSE);
    state->setAttributeAndModes(material);
    state->setMode(GL_NORMALIZE, osg::StateAttribute::ON);
    state->setMode(GL_CULL_FACE, osg::StateAttribute::ON);

    osgViewer::Viewer& viewer = parts->viewer;
    viewer.setThreadingModel(osgViewer::ViewerBase::SingleThreaded);
    viewer.setUseConfigureAffinity(false);  // or every thread would share one core
    viewer.setLightingMode(osg::View::SKY_LIGHT);
    viewer.getLight()->setPosition({0.5f, 0.8f, 0.35f, 0});
    osg::Camera* eye = viewer.getCamera();
    eye->setGraphicsContext(context);
    eye->setViewport(0, 0, settings.width, settings.height);
    eye->setClearColor({0.4f, 0.5f, 0.6f, 1});
    eye->setComputeNearFarMode(osg::CullSettings::DO_NOT_COMPUTE_NEAR_FAR);
    eye->setCullingMode(osg::CullSettings::VIEW_FRUSTUM_SIDES_CULLING);
    const double aspect = double(settings.width) / settings.height;
    eye->setProjectionMatrixAsPerspective(glm::degrees(camera.verticalFov), aspect, 0.5, 4000);
    eye->setViewMatrixAsLookAt(vec(camera.eye), vec(camera.at), vec(camera.up));
    parts->finish->width = settings.width;
    parts->finish->height = settings.height;
    eye->setFinalDrawCallback(parts->finish);
    eye->getStats()->collectStats("scene", true);
    viewer.setSceneData(root);
    viewer.realize();
    return OsgView(std::move(parts));
}

double OsgView::frame() {
    const auto begin = std::chrono::steady_clock::now();
    parts->viewer.frame();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin)
        .count();
}

std::uint64_t OsgView::triangles() const {
    double count = 0;
    const osg::Stats* stats = parts->viewer.getCamera()->getStats();
    stats->getAttribute(stats->getLatestFrameNumber(), "Visible number of GL_TRIANGLES", count);
    return static_cast<std::uint64_t>(count);
}

std::string OsgView::renderer() const {
    return parts->finish->renderer;
}

quality::RgbImage OsgView::picture() const {
    parts->finish->read = true;
    parts->viewer.frame();
    parts->finish->read = false;
    const Settings& s = parts->settings;
    quality::RgbImage picture(s.width, s.height);
    for (int y = 0; y < s.height; ++y)  // OpenGL's rows go up
        std::copy_n(parts->finish->image->data(0, s.height - 1 - y), 3 * s.width, picture.at(0, y));
    return picture;
}

}  // namespace lodestar::app
