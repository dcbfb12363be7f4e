// SPDX-License-Identifier: MIT
// OpenMesh exporter over plain vectors: a non-manifold surface passes through unchanged.
#include "formats/surface/surface_openmesh.hpp"

#include "formats/io/error.hpp"

#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/System/omstream.hh>

#include <Eigen/Geometry>
#include <algorithm>
#include <iomanip>
#include <sstream>

namespace palpate {
namespace {

using OpenMesh::EdgeHandle;
using OpenMesh::FaceHandle;
using OpenMesh::HalfedgeHandle;
using OpenMesh::VertexHandle;
using OpenMesh::Attributes::StatusInfo;
namespace om = OpenMesh;

// Offers points and triangles; everything else is absent.
class SurfaceExporter final : public om::IO::BaseExporter {
public:
  explicit SurfaceExporter(const Surface& surface) : surface_(surface) {}

  om::Vec3f point(VertexHandle v) const override {
    const Eigen::Vector3f p = at(v).cast<float>();
    return {p.x(), p.y(), p.z()};
  }
  om::Vec3d pointd(VertexHandle v) const override { return {at(v).x(), at(v).y(), at(v).z()}; }
  bool is_point_double() const override { return true; }
  unsigned int get_vhandles(FaceHandle f, std::vector<VertexHandle>& corners) const override {
    corners.clear();
    for (const auto vertex : surface_.triangles[std::size_t(f.idx())]) corners.emplace_back(vertex);
    return 3;
  }
  om::Vec3f normal(FaceHandle f) const override { return om::Vec3f(normald(f)); }
  om::Vec3d normald(FaceHandle f) const override {
    const auto& t = surface_.triangles[std::size_t(f.idx())];
    const auto& a = surface_.vertices[std::size_t(t[0])];
    const Eigen::Vector3d n =
        (surface_.vertices[std::size_t(t[1])] - a).cross(surface_.vertices[std::size_t(t[2])] - a).stableNormalized();
    return {n.x(), n.y(), n.z()};
  }
  std::size_t n_vertices() const override { return surface_.vertices.size(); }
  std::size_t n_faces() const override { return surface_.triangles.size(); }
  std::size_t n_edges() const override { return 0; }
  bool is_triangle_mesh() const override { return true; }
  // The OBJ writer looks for texture properties in the kernel without a check that there is one.
  const om::BaseKernel* kernel() override { return &no_properties_; }

  om::Vec3f normal(VertexHandle) const override { return om::Vec3f(0, 0, 0); }
  om::Vec3d normald(VertexHandle) const override { return om::Vec3d(0, 0, 0); }
  bool is_normal_double() const override { return false; }
  om::Vec3uc color(VertexHandle) const override { return om::Vec3uc(0, 0, 0); }
  om::Vec4uc colorA(VertexHandle) const override { return om::Vec4uc(0, 0, 0, 0); }
  om::Vec3ui colori(VertexHandle) const override { return om::Vec3ui(0, 0, 0); }
  om::Vec4ui colorAi(VertexHandle) const override { return om::Vec4ui(0, 0, 0, 0); }
  om::Vec3f colorf(VertexHandle) const override { return om::Vec3f(0, 0, 0); }
  om::Vec4f colorAf(VertexHandle) const override { return om::Vec4f(0, 0, 0, 0); }
  om::Vec2f texcoord(VertexHandle) const override { return om::Vec2f(0, 0); }
  om::Vec2f texcoord(HalfedgeHandle) const override { return om::Vec2f(0, 0); }
  StatusInfo status(VertexHandle) const override { return {}; }
  HalfedgeHandle getHeh(FaceHandle, VertexHandle) const override { return HalfedgeHandle(); }
  unsigned int get_face_texcoords(std::vector<om::Vec2f>&) const override { return 0; }
  om::Vec3uc color(FaceHandle) const override { return om::Vec3uc(0, 0, 0); }
  om::Vec4uc colorA(FaceHandle) const override { return om::Vec4uc(0, 0, 0, 0); }
  om::Vec3ui colori(FaceHandle) const override { return om::Vec3ui(0, 0, 0); }
  om::Vec4ui colorAi(FaceHandle) const override { return om::Vec4ui(0, 0, 0, 0); }
  om::Vec3f colorf(FaceHandle) const override { return om::Vec3f(0, 0, 0); }
  om::Vec4f colorAf(FaceHandle) const override { return om::Vec4f(0, 0, 0, 0); }
  StatusInfo status(FaceHandle) const override { return {}; }
  om::Vec3uc color(EdgeHandle) const override { return om::Vec3uc(0, 0, 0); }
  om::Vec4uc colorA(EdgeHandle) const override { return om::Vec4uc(0, 0, 0, 0); }
  om::Vec3ui colori(EdgeHandle) const override { return om::Vec3ui(0, 0, 0); }
  om::Vec4ui colorAi(EdgeHandle) const override { return om::Vec4ui(0, 0, 0, 0); }
  om::Vec3f colorf(EdgeHandle) const override { return om::Vec3f(0, 0, 0); }
  om::Vec4f colorAf(EdgeHandle) const override { return om::Vec4f(0, 0, 0, 0); }
  StatusInfo status(EdgeHandle) const override { return {}; }
  int get_halfedge_id(VertexHandle) override { return -1; }
  int get_halfedge_id(FaceHandle) override { return -1; }
  int get_next_halfedge_id(HalfedgeHandle) override { return -1; }
  int get_to_vertex_id(HalfedgeHandle) override { return -1; }
  int get_face_id(HalfedgeHandle) override { return -1; }
  StatusInfo status(HalfedgeHandle) const override { return {}; }

private:
  const Eigen::Vector3d& at(VertexHandle v) const { return surface_.vertices[std::size_t(v.idx())]; }
  const Surface& surface_;
  om::TriMesh_ArrayKernelT<> no_properties_;
};

// OpenMesh talks to standard error of its own accord; what matters is said in our errors.
class QuietOpenMesh {
public:
  QuietOpenMesh() : errors_(omerr().is_enabled()), notes_(omlog().is_enabled()) {
    omerr().disable();
    omlog().disable();
  }
  ~QuietOpenMesh() {
    if (errors_) omerr().enable();
    if (notes_) omlog().enable();
  }
  QuietOpenMesh(const QuietOpenMesh&) = delete;
  QuietOpenMesh& operator=(const QuietOpenMesh&) = delete;

private:
  bool errors_, notes_;
};

}  // namespace

std::string write_with_openmesh(const Surface& surface, const std::string& extension) {
  const QuietOpenMesh quiet;
  SurfaceExporter exporter(surface);
  std::ostringstream stream;
  const auto options = extension == ".stl" ? om::IO::Options::Binary : om::IO::Options::Default;
  if (!om::IO::IOManager().write(stream, extension.substr(1), exporter, options, 9) || !stream) {
    throw Error(ExitCode::bad_input, "OpenMesh cannot write this surface as " + extension);
  }
  return stream.str();
}

}  // namespace palpate
