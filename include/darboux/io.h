/// \file io.h
/// Files: glTF and GLB over the JSON document itself; PLY, STL, COLLADA, OBJ and FBX; sampled points;
/// surfaces that a user wrote down. Every float of a glTF keeps its bits. Target darboux::io.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include <darboux/any_surface.h>
#include <darboux/frame.h>
#include <darboux/mesh.h>
#include <darboux/point_cloud.h>
#include <darboux/vector.h>

namespace darboux {

/// What a file may do while it is read.
struct ReadOptions {
  /// Whether a document may name files outside its folder, by ../ or a symbolic link. false: opening such a
  /// file is an error.
  bool allow_outside = false;
  /// Whether the child process that reads OBJ and FBX (by assimp) is confined: it can open no file, use no
  /// network and start nothing. Needs Linux with seccomp on x86-64 or AArch64; elsewhere such a file is an
  /// error unless this is false.
  bool sandbox = true;
  /// Bytes that the content of a glTF, COLLADA, PLY or image may take, decoded: vertices of all primitives,
  /// triangles (128 bytes each, with what judging them takes), instances, morph targets, compressed streams,
  /// texels. They are counted one by one, so that a file that asks for more is an error at once. Without: 512
  /// MiB for files of less than 10 MB, which may ask for much more than they hold; for others 4 GiB, or 16
  /// times the file where that is more.
  std::optional<std::uint64_t> max_memory = std::nullopt;
};

/// World matrices of the nodes that show a mesh, one per instance. Immutable: copies share the matrices, and
/// so do the primitives of one mesh.
class Instances {
 public:
  Instances() = default;
  Instances(std::vector<Eigen::Matrix4d> matrices)  // NOLINT: converting
      : matrices_(std::make_shared<const std::vector<Eigen::Matrix4d>>(std::move(matrices))) {}

  std::span<const Eigen::Matrix4d> matrices() const {
    return matrices_ ? std::span(*matrices_) : std::span<const Eigen::Matrix4d>();
  }
  std::size_t size() const { return matrices().size(); }
  bool empty() const { return matrices().empty(); }
  const Eigen::Matrix4d& operator[](std::size_t i) const { return matrices()[i]; }
  auto begin() const { return matrices().begin(); }
  auto end() const { return matrices().end(); }
  friend bool operator==(const Instances& a, const Instances& b) {
    return a.matrices_ == b.matrices_ || std::equal(a.begin(), a.end(), b.begin(), b.end());
  }

 private:
  std::shared_ptr<const std::vector<Eigen::Matrix4d>> matrices_;  ///< null: none
};

/// One drawable piece of a file: a primitive of a glTF mesh, a group of polygons of a COLLADA geometry, a
/// mesh of an OBJ or FBX, a solid of an STL, a PLY.
struct Primitive {
  std::size_t mesh = 0;       ///< index of the mesh in the file
  std::size_t primitive = 0;  ///< index within the mesh
  std::string name;           ///< the mesh's name, may be empty
  /// Which TEXCOORD set `data.uvs` holds; -1 when there is none. For glTF it is the set of the material's
  /// first texture that reads the tangent frame, if the primitive has that set, else 0. The normal texture
  /// comes first, then the others in the order of needs_tangents. For other formats it is the file's first
  /// set.
  int texcoord = -1;
  /// Whether something in its material, or in one of its KHR_materials_variants, reads the tangent frame: a
  /// normalTexture, the clearcoatNormalTexture of KHR_materials_clearcoat, KHR_materials_anisotropy, the
  /// normal maps of MSFT_packing_normalRoughnessMetallic and MSFT_packing_occlusionRoughnessMetallic.
  /// Empty if the format does not say, that is, if it is not glTF.
  std::optional<bool> needs_tangents{};
  /// In the mesh's own space; vertex i is a glTF's or PLY's vertex i. Normalised integers are read as the
  /// numbers they stand for, NaN and infinities as they are; strips and fans become triangles in glTF's
  /// winding.
  Mesh data;
  /// World matrices of the nodes that show it, one per instance; empty when no node does.
  Instances instances;
  /// Its other uv sets, each with its number, where it has tangents and uvs: the tangents may follow one of
  /// them. A glTF's are TEXCOORD_0 to TEXCOORD_7.
  std::vector<std::pair<int, std::vector<Vec2<double>>>> other_uvs;
  /// Whether the material says which set its tangents belong to. Where it does not, any set will do.
  bool names_uv_set = false;
  /// KHR_texture_transform of the texture that names the set: uv' = M uv + offset, M row by row, then the
  /// offset. Not applied to `data`.
  std::optional<std::array<double, 6>> texture_transform;
  /// What w of its tangents means. COLLADA and FBX store binormals, which exporters have along v: raw.
  SignConvention sign = SignConvention::gltf;
  /// Indices at the end that are no whole triangle; they are left out.
  std::size_t leftover_indices = 0;
  /// The TEXCOORD set of the material's first texture that reads the tangent frame, if the mesh lacks that
  /// set.
  std::optional<std::uint64_t> missing_texcoord{};
  /// How many morph targets it has, of a glTF; `data` is the mesh at weights of 0.
  /// GltfDocument::morph_targets reads them.
  std::size_t morph_targets = 0;
};

/// What a morph target of a primitive adds to its vertices at weight 1, one entry per vertex; empty where it
/// adds nothing.
struct MorphTarget {
  std::vector<Vec3<double>> positions, normals;
  std::vector<Vec2<double>> uvs;  ///< of the set that Primitive::texcoord names
};

/// A piece of a file that was passed over.
struct SkippedPrimitive {
  std::size_t mesh = 0, primitive = 0;
  std::string reason;  ///< e.g. "mode 1 (lines) has no triangles"
};

/// What a file holds. A valid glTF without meshes gives an empty one.
struct Asset {
  std::vector<Primitive> primitives;
  std::vector<SkippedPrimitive> skipped;
};

/// Reads .glb, .gltf, .obj, .fbx, .dae, .ply or .stl, chosen by the content where it tells (the magic
/// "glTF"), else by the extension. Units and up axes are not applied: positions are as stored, in the mesh's
/// own space.
///
/// glTF 2.0: every componentType, interleaved and sparse accessors, normalised integers
/// (KHR_mesh_quantization), buffers in the GLB, in files beside it (relative URIs) or in data URIs.
/// EXT_meshopt_compression and KHR_draco_mesh_compression are undone when the file is loaded, whether there
/// are uncompressed data too or not. Instances are the nodes of the default scene: the one named, else the
/// first, else all trees of nodes. Morph targets and skins are not applied.
///
/// PLY: ASCII or binary of either byte order, in double; normals and uvs under the names that read_points()
/// knows, no tangents; polygons become fans about their first corner; faces with a list texcoord have a
/// vertex per corner. Without faces the asset is empty, and `skipped` says so.
///
/// STL: a vertex per corner, positions alone. The stored normals are not read. They are normals of facets:
/// they repeat what the winding tells, are zero in many files, and as vertex normals would only say that the
/// mesh has facets.
///
/// COLLADA 1.4 and 1.5, in double: a vertex per corner; polygons become fans about their first corner, those
/// with holes are skipped; tangents where there are normals, TEXTANGENT and TEXBINORMAL, w the side of
/// cross(n, t) on which the bitangent lies (0: on neither). Controllers show the mesh at rest.
///
/// OBJ and FBX (of 2011 or later, binary or text) by assimp: a vertex per corner, in float, decimals within 2
/// units in the last place (measured 1); quads are cut from a concave corner, larger polygons by their ears;
/// v up as stored. FBX has tangents as COLLADA has; without bitangents in the file assimp takes cross(n, t),
/// so that w = 1. Attributes that FBX maps in ways that assimp does not know are left out. Materials and
/// textures are not opened. assimp runs in a process of its own, so that no file can crash or stop this one:
/// it may take 1 GiB and 256 times the file, 20 seconds and 2 for each MB.
///
/// Normals of OBJ and PLY, formats that promise no length, are made unit where they are not; zeros stay.
///
/// Nothing is allocated by a count the file states before the count is checked against the bytes it has.
/// \throws FileError naming the file, the place in it, what is expected there and what it has
Asset read_asset(const std::string& path, const ReadOptions& options = {});

/// The extensions of the files that read_asset() reads: ".glb".
std::span<const std::string_view> asset_extensions();

struct GltfFile;  // the JSON document and its buffers: src/io/gltf_file.h

/// A glTF or GLB file held as its JSON document and its buffers, to be rewritten with everything else
/// preserved: only accessors, bufferViews, buffer lengths and the references of the rewritten primitives
/// change. What EXT_meshopt_compression and KHR_draco_mesh_compression compress is decoded at once and
/// written uncompressed. Values stay the same, doubles to the bit, and unknown properties, chunks and the
/// order of keys are kept.
class GltfDocument {
 public:
  /// \throws FileError as read_asset does; errors in meshes and nodes are found by asset()
  static GltfDocument load(const std::string& path, const ReadOptions& options = {});
  /// A new one, with a mesh and a node for each primitive, in their order, as write_glb() writes them.
  /// \param path what messages call it \throws MeshError as write_glb() does
  static GltfDocument of(const Asset& asset, const std::string& path);
  GltfDocument(GltfDocument&&) noexcept;
  GltfDocument& operator=(GltfDocument&&) noexcept;
  ~GltfDocument();

  /// The file it was loaded from.
  const std::string& path() const;

  /// The triangles in it, edits included. \throws FileError
  Asset asset() const;

  /// The morph targets of a primitive that asset() gave. \throws FileError
  std::vector<MorphTarget> morph_targets(const Primitive& primitive) const;

  /// Gives one primitive a TANGENT accessor (float VEC4, one per vertex), appended to the binary chunk; an
  /// old one is left where it is, unreferenced by this primitive. Values are stored bit for bit and not
  /// judged. \param deltas what each morph target adds to x, y and z: a TANGENT accessor (float VEC3) for
  /// each; none at all: the targets are left as they are \throws MeshError when the primitive does not exist,
  /// a count differs from POSITION's or that of deltas from the targets'
  void set_tangents(std::size_t mesh, std::size_t primitive, std::span<const Vec4<float>> tangents,
                    std::span<const std::vector<Vec3<float>>> deltas = {});

  /// Gives one primitive new vertices: every attribute, morph targets included, is copied so that new vertex
  /// i is old vertex source[i], bit for bit, and the primitive becomes the triangle list `indices`. min and
  /// max are computed anew where they stood. Other primitives keep the old accessors, shared ones too.
  /// \param without_tangents TANGENT is not copied, and does not fit until set_tangents() replaces it, the
  /// morph targets' too \throws MeshError when the primitive does not exist, source names no old vertex, or
  /// indices no new one \throws FileError when an attribute cannot be read
  void remap_vertices(std::size_t mesh, std::size_t primitive, std::span<const std::uint32_t> source,
                      std::span<const std::uint32_t> indices, bool without_tangents = false);

  /// Shows one primitive in these colours and nothing else: gives it a COLOR_0 accessor (float VEC3, linear
  /// RGB, one per vertex), appended to the binary chunk, and a white material that is not lit
  /// (KHR_materials_unlit), one for the whole document. Its old colours and material stay where they are;
  /// KHR_materials_variants, which would hide the colours, goes. \param extras_json a JSON object whose keys
  /// the mesh's extras get, unless they are something else than an object \throws MeshError when the
  /// primitive does not exist or the count differs from POSITION's \throws ParameterError when extras_json is
  /// no object
  void set_colours(std::size_t mesh, std::size_t primitive, std::span<const Vec3<float>> colours,
                   const std::string& extras_json);

  /// Writes a self-contained GLB, whole or not at all. The bytes of buffer 0 begin the binary chunk, all that
  /// was added follows. Files that other buffers and images name by relative URI are embedded as data URIs,
  /// so that no bufferView moves; an image that cannot be read, or whose kind is unknown, keeps its URI.
  /// \returns why, a line for each such image
  /// \throws FileError, also for an image that ReadOptions::allow_outside would have to permit
  std::vector<std::string> save_glb(const std::string& path) const;

  /// What it holds, for darboux's own functions.
  const GltfFile& file() const { return *file_; }
  GltfFile& file() { return *file_; }

 private:
  explicit GltfDocument(std::unique_ptr<GltfFile> file);
  std::unique_ptr<GltfFile> file_;
};

/// Writes one mesh, with one node that shows it, as a GLB: float32 attributes, 16-bit indices where they
/// suffice, else 32-bit, POSITION with min and max. Doubles are rounded to the nearest float; normals, uvs
/// and tangents are stored as they come, NaN included, and not renormalised. \param name the mesh's name;
/// bytes that are not UTF-8 become U+FFFD \param extras_json a JSON object stored as the mesh's extras, or
/// empty \throws FileError when it cannot be written \throws MeshError when the mesh is inconsistent or has
/// no triangles, or a position is not finite as a float \throws ParameterError when extras_json is not a JSON
/// object
void write_glb(const std::string& path, const Mesh& mesh, const std::string& name,
               const std::string& extras_json = {});

/// Points read from a file.
struct PointFile {
  PointCloud cloud;  ///< every point or vertex of the file, in its order
  /// For each vertex of a mesh, the first vertex at the same place (within 1e-6 of the diagonal), which may
  /// be itself; `unused` where no triangle uses it. Empty where there are no triangles.
  std::vector<std::uint32_t> place;
  static constexpr std::uint32_t unused = 0xffffffff;
  /// Where the first position that is not finite stands: "line 7", "vertex 3" (from 0). Empty where all are
  /// finite.
  std::string first_not_finite;
  std::string note;  ///< one line about columns that were passed over; mostly empty
};

/// What was measured: one point per place, the first. Vertices at the same place are one measurement, split
/// for its attributes.
PointCloud distinct_points(const PointFile& file);

/// Reads sampled points, in the order of the file, by its extension:
///   .xyz .txt .csv .tsv .asc .pts  a point per line, columns between semicolons, else commas, else blanks or tabs (the
///                        first line decides), in quotes or not. A header, which begins with a name or an
///                        empty field, names them in any order and case: x y z, nx ny nz, u v; columns of
///                        other names, and groups that are not complete, are passed over. It may stand behind
///                        // or #, with as many names as there are columns. Without a header: 3 columns are
///                        x y z, 5 are x y z u v, 6 are x y z nx ny nz, 8 are all of these. With 4, 7 or
///                        more than 8 columns, those after z are passed over, with a note; likewise if
///                        nx ny nz are finite and not zero, but not of unit length (10 %). Row numbers in
///                        the place of x are refused.
///   .ply  the vertices, ASCII or binary of either byte order, normals and uvs included
///   .pcd  ASCII, binary or compressed binary; the viewpoint is not applied
///   .obj  the vertices, where there are faces with the attributes of the first corner
///   .stl  the corners, ASCII or binary, without the triangles' normals
///   .glb .gltf  the vertices, one primitive after the other, in the mesh's space: nodes are not applied;
///               normals and uvs where every primitive has them
/// Other names of columns: position_x ..., normal_x ..., s t, texture_u texture_v. Empty lines and those that
/// begin with # are passed over. NaN and infinities are read as they are.
///
/// Numbers are read in double, correctly rounded (glTF: float, as stored). Tables, PLY and PCD are read in
/// pieces: memory is at most three times the cloud. A count the file states is checked against what it holds.
/// \param progress called now and then with the share that is read
/// \throws FileError naming the file, its line or vertex, what is expected there and what it has; at least
/// one point is expected
PointFile read_points(const std::string& path, const std::function<void(double)>& progress = {},
                      const ReadOptions& options = {});

/// Whether a path names standard output: "-", /dev/stdout, /dev/fd/1 or a link to one of them.
bool is_standard_output(const std::string& path);

/// A file that is written piece by piece, and appears whole or not at all. It has no name until commit()
/// gives it one, so an old file stays until the new one is complete. Without commit() nothing is left. If the
/// file system has no nameless files, or cannot name them later, the content is in a hidden file beside the
/// target until commit() (.darboux-*.tmp); a process that is killed leaves that file behind.
///
/// A file that exists is replaced: its mode is kept, and its owner and group where that is permitted; other
/// hard links keep the old content; a symbolic link stays, and what it names is replaced or made. A file that
/// is read-only is refused. What names a descriptor of this process ("-" is standard output, /dev/stdout,
/// /dev/fd/N), a device or a pipe is written to directly, from where it stands.
///
/// The constructor, write() and commit() throw FileError: the path is a folder, its folder is missing or not
/// writable, the file is read-only, the disk is full.
class OutputFile {
 public:
  explicit OutputFile(const std::string& path);
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;
  ~OutputFile();
  void write(std::string_view content);
  void commit();
  /// Whether the path names a descriptor of this process that is an open regular file. Others that read this
  /// file see each write.
  bool is_written_in_place() const;

 private:
  void flush();
  void give_name();
  bool link_name();  // false where the file system gives it none
  void copy_to_temporary();
  void rename_temporary();
  std::string path_;       // as messages name it
  std::string target_;     // what is replaced; empty where descriptor_ is the target itself
  std::string temporary_;  // the hidden name, while there is one
  std::string buffer_;
  int descriptor_ = -1;
};

/// Writes a whole file at once, as OutputFile does. \throws FileError
void write_file(const std::string& path, std::string_view content);

/// A surface from its formula in a text file, over u and v in [0, 1], both linear:
///
///     # the catenoid
///     a = 2                          # radius of the neck; length
///     t = 2*v - 1
///     x = a*cosh(t)*cos(2*pi*u)
///     y = a*cosh(t)*sin(2*pi*u)
///     z = a*t
///
/// One definition per line, in any order; # begins a comment. x, y and z are the position. A name whose
/// expression has numbers and pi only is a parameter (its comment says what it means), its value a double;
/// any other is an abbreviation. Operators, strongest first: ^ (from the right), + and - as signs, * and /, +
/// and -, comparisons, &&, ||, condition ? a : b. Functions: sin cos tan asin acos atan atan2(y, x), sinh
/// cosh tanh asinh acosh atanh, sqrt exp, log and ln (natural), pow(a, b), abs sign, min(a, b) max(a, b), and
/// sin_turns(t), cos_turns(t): sine and cosine of 2πt with exact range reduction, so that quarter turns are
/// exact and u + 1 gives the bits of u.
///
/// The file is parsed once. Every scalar runs the same instructions, so the partials come from nested dual
/// numbers, exact to the formula's own rounding, and every law of testing.h holds or is broken as for a type
/// in C++. pi has the digits of the scalar; a number in the text is the nearest double. A power with a
/// constant whole exponent up to 1024 is a product, so it takes negative bases; other powers take positive
/// bases. Where the formula has no value (log of a negative number, 0/0) it gives NaN or infinity, status
/// `no_frame` and `overflow`, and `check` says so. Nothing declares where the chart is singular or meets
/// itself: seams are edges, and poles are found only where a partial is exactly zero.
///
/// \param parameters other values for some of the parameters
/// \throws FileError naming file and line: no definition, a name twice or reserved, x, y or z missing, an
/// unknown name (the known ones are listed), definitions that need each other, a syntax error with its
/// column, a parameter that is not finite \throws ParameterError for an unknown parameter or a value that is
/// not finite
AnySurface read_formula_surface(const std::string& path,
                                const std::vector<std::pair<std::string, double>>& parameters = {});

/// The kinds that read_surface_file() knows.
const std::vector<std::string_view>& surface_file_kinds();

/// A surface of one of these kinds from a JSON object; other keys are refused.
///   bezier-patch            points, weights, degree_u, degree_v
///   bspline-patch           points, weights, degree_u, degree_v, knots_u, knots_v
///   surface-of-revolution   points, weights, degree, knots: the profile
/// A patch's points are rows [[[x, y, z], ...], ...]: row i holds P_i0, P_i1, ..., so u runs from row to row
/// and v along each. A profile's points are [[ρ, z], ...]. weights: rows of positive numbers as the points,
/// all 1 when missing. Degrees are 1 to 15. bezier-patch's follow from the points, and must agree where they
/// are given; a profile's is 1 (a polyline) when missing. knots: as many as points + degree + 1, not
/// decreasing, none more than degree + 1 times; when missing, clamped and equally spaced. Any knots are
/// mapped to [0, 1]. \throws FileError naming file, key and what is expected there \throws ParameterError for
/// another kind
AnySurface read_surface_file(std::string_view kind, const std::string& path);

}  // namespace darboux
