/// \file io.h
/// File formats: glTF and GLB, edited as JSON documents; PLY, STL, COLLADA, OBJ and FBX; sampled points;
/// user-defined surfaces. Floats of glTF files are preserved bit for bit. Target darboux::io.
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

/// Security limits for reading files.
struct ReadOptions {
  /// Whether a document may refer to files outside its folder, by ../ or a symbolic link. If false, opening
  /// such a file is an error.
  bool allow_outside = false;
  /// Whether to sandbox the child process that reads OBJ and FBX with assimp: it cannot open files, use the
  /// network or start processes. Requires Linux with seccomp on x86-64 or AArch64; elsewhere such a file is
  /// an error unless this is false.
  bool sandbox = true;
  /// Limit for the decoded content of a glTF, COLLADA, PLY or image file, in bytes: vertices of all
  /// primitives, triangles (128 bytes each, including the memory for judging them), instances, morph targets,
  /// compressed streams, texels. They are counted before allocation, so a file that exceeds the limit fails
  /// immediately. Default: 512 MiB for files of less than 10 MB, since small files can declare huge content;
  /// for others 4 GiB, or 16 times the file size if that is more.
  std::optional<std::uint64_t> max_memory = std::nullopt;
};

/// World matrices of the nodes that reference a mesh, one per instance. Immutable: copies, and the primitives
/// of one mesh, share the matrices.
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
  /// The TEXCOORD set in `data.uvs`; -1 if there is none. For glTF it is the set of the material's first
  /// texture that reads the tangent frame, if the primitive has that set, else 0. The normal texture comes
  /// first, then the others in the order of needs_tangents. For other formats it is the file's first set.
  int texcoord = -1;
  /// Whether something in its material, or in one of its KHR_materials_variants, reads the tangent frame: a
  /// normalTexture, the clearcoatNormalTexture of KHR_materials_clearcoat, KHR_materials_anisotropy, the
  /// normal maps of MSFT_packing_normalRoughnessMetallic and MSFT_packing_occlusionRoughnessMetallic.
  /// Empty if the format does not contain this information, that is, if it is not glTF.
  std::optional<bool> needs_tangents{};
  /// In the local space of the mesh. For glTF and PLY, vertex i is vertex i of the file. Normalised integers
  /// are dequantised; NaN and infinities are kept; strips and fans become triangles with glTF's winding.
  Mesh data;
  /// World matrices of the nodes that reference it, one per instance; empty if none does.
  Instances instances;
  /// Its other uv sets, each with its number, where it has tangents and uvs: the tangents may follow one of
  /// them. A glTF's are TEXCOORD_0 to TEXCOORD_7.
  std::vector<std::pair<int, std::vector<Vec2<double>>>> other_uvs;
  /// Whether the material determines the uv set of the tangents. If not, any set is accepted.
  bool names_uv_set = false;
  /// KHR_texture_transform of the texture that names the set: uv' = M uv + offset, M row by row, then the
  /// offset. Not applied to `data`.
  std::optional<std::array<double, 6>> texture_transform;
  /// The sign convention of w. raw for COLLADA and FBX, which store binormals that exporters write along v.
  SignConvention sign = SignConvention::gltf;
  /// Trailing indices that do not form a whole triangle; they are ignored.
  std::size_t leftover_indices = 0;
  /// The TEXCOORD set of the material's first texture that reads the tangent frame, if the mesh lacks that
  /// set.
  std::optional<std::uint64_t> missing_texcoord{};
  /// Number of morph targets (glTF); `data` is the mesh with all weights 0. GltfDocument::morph_targets reads
  /// them.
  std::size_t morph_targets = 0;
};

/// The displacements that a morph target adds to the vertices of a primitive at weight 1, one entry per
/// vertex. An attribute that the target does not change is empty.
struct MorphTarget {
  std::vector<Vec3<double>> positions, normals;
  std::vector<Vec2<double>> uvs;  ///< of the set that Primitive::texcoord names
};

/// A piece of a file that was skipped.
struct SkippedPrimitive {
  std::size_t mesh = 0, primitive = 0;
  std::string reason;  ///< e.g. "mode 1 (lines) has no triangles"
};

/// The content of a file. Empty for a valid glTF file without meshes.
struct Asset {
  std::vector<Primitive> primitives;
  std::vector<SkippedPrimitive> skipped;
};

/// Reads .glb, .gltf, .obj, .fbx, .dae, .ply or .stl. The format is detected by content if possible (the
/// magic "glTF"), otherwise by the extension. Units and up axes are not applied: positions are as stored, in
/// the mesh's own space.
///
/// glTF 2.0: every componentType, interleaved and sparse accessors, normalised integers
/// (KHR_mesh_quantization), buffers in the GLB, in files beside it (relative URIs) or in data URIs.
/// EXT_meshopt_compression and KHR_draco_mesh_compression are decoded on loading, even if there are
/// uncompressed data as well. Instances are the nodes of the default scene: the one named, else the first,
/// else all trees of nodes. Morph targets and skins are not applied.
///
/// PLY: ASCII or binary of either byte order, in double; normals and uvs under the names that read_points()
/// knows, no tangents; polygons become fans about their first corner; faces with a list texcoord have a
/// vertex per corner. Without faces the asset is empty, and `skipped` says so.
///
/// STL: a vertex per corner, positions only. The stored normals are not read: they are facet normals, which
/// only repeat the winding, and are zero in many files.
///
/// COLLADA 1.4 and 1.5, in double: a vertex per corner; polygons become fans about their first corner, those
/// with holes are skipped; tangents where there are normals, TEXTANGENT and TEXBINORMAL, w the side of
/// cross(n, t) on which the bitangent lies (0: on neither). Controllers show the mesh at rest.
///
/// OBJ and FBX (of 2011 or later, binary or text) by assimp: a vertex per corner, in float, decimals within 2
/// units in the last place (measured 1); quads are cut from a concave corner, larger polygons by their ears;
/// v up as stored. FBX has tangents as COLLADA has; without bitangents in the file assimp takes cross(n, t),
/// so that w = 1. FBX attributes with mappings that assimp does not support are omitted. Materials and
/// textures are not opened. assimp runs in a separate process, so that no file can crash or block this one.
/// Its limits are 1 GiB plus 256 times the file size, and 20 seconds plus 2 per MB.
///
/// Normals of OBJ and PLY, which need not be unit in these formats, are normalised; zeros are kept.
///
/// Counts stated in the file are checked against its size before memory is allocated.
/// \throws FileError naming the file, the position in it, and what was expected and found there
Asset read_asset(const std::string& path, const ReadOptions& options = {});

/// The extensions of the files that read_asset() reads: ".glb".
std::span<const std::string_view> asset_extensions();

struct GltfFile;  // the JSON document and its buffers: src/io/gltf_file.h

/// A glTF or GLB file, represented by its JSON document and buffers. Edits preserve everything else: only
/// accessors, bufferViews, buffer lengths and the references of edited primitives change. Data compressed
/// with EXT_meshopt_compression or KHR_draco_mesh_compression are decoded on loading and written
/// uncompressed. Values are preserved (doubles bit for bit), as are unknown properties, chunks and the order
/// of keys.
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

  /// The meshes of the document, including edits. \throws FileError
  Asset asset() const;

  /// The morph targets of a primitive that asset() gave. \throws FileError
  std::vector<MorphTarget> morph_targets(const Primitive& primitive) const;

  /// Adds a TANGENT accessor (float VEC4, one per vertex) to one primitive, appended to the binary chunk. An
  /// existing accessor remains in the file, unreferenced by this primitive. Values are stored bit for bit,
  /// without checks. \param deltas the change of x, y and z by each morph target, stored as one TANGENT
  /// accessor (float VEC3) per target; empty: the targets are not changed \throws MeshError when the
  /// primitive does not exist, a count differs from POSITION's or that of deltas from the targets'
  void set_tangents(std::size_t mesh, std::size_t primitive, std::span<const Vec4<float>> tangents,
                    std::span<const std::vector<Vec3<float>>> deltas = {});

  /// Replaces the vertices of one primitive: every attribute, including morph targets, is copied bit for bit
  /// so that new vertex i is old vertex source[i], and the primitive becomes the triangle list `indices`. min
  /// and max are recomputed where present. Other primitives keep the old accessors, including shared ones.
  /// \param without_tangents TANGENT is not copied, and does not fit until set_tangents() replaces it, the
  /// morph targets' too \throws MeshError when the primitive does not exist, source names no old vertex, or
  /// indices no new one \throws FileError when an attribute cannot be read
  void remap_vertices(std::size_t mesh, std::size_t primitive, std::span<const std::uint32_t> source,
                      std::span<const std::uint32_t> indices, bool without_tangents = false);

  /// Makes one primitive show only the given colours: adds a COLOR_0 accessor (float VEC3, linear RGB, one
  /// per vertex), appended to the binary chunk, and a white unlit material (KHR_materials_unlit), one for the
  /// whole document. Its old colours and material remain in the file; KHR_materials_variants, which would
  /// hide the colours, is removed. \param extras_json a JSON object whose keys the mesh's extras get, unless
  /// they are something else than an object \throws MeshError when the primitive does not exist or the count
  /// differs from POSITION's \throws ParameterError when extras_json is no object
  void set_colours(std::size_t mesh, std::size_t primitive, std::span<const Vec3<float>> colours,
                   const std::string& extras_json);

  /// Writes a self-contained GLB, completely or not at all. The binary chunk begins with the bytes of buffer
  /// 0, followed by added data. Other buffers and images that refer to files by relative URI are embedded as
  /// data URIs, so that no bufferView moves. An image that cannot be read, or is of an unknown kind, keeps
  /// its URI. \returns the reason for each such image, one line each
  /// \throws FileError, also for an image that ReadOptions::allow_outside would have to permit
  std::vector<std::string> save_glb(const std::string& path) const;

  /// The document and its buffers, for internal use.
  const GltfFile& file() const { return *file_; }
  GltfFile& file() { return *file_; }

 private:
  explicit GltfDocument(std::unique_ptr<GltfFile> file);
  std::unique_ptr<GltfFile> file_;
};

/// Writes one mesh and one node that references it as a GLB: float32 attributes; 16-bit indices if they
/// suffice, else 32-bit; POSITION with min and max. Doubles are rounded to the nearest float. Normals, uvs
/// and tangents are stored unchanged, including NaN, and not renormalised. \param name the mesh's name; bytes
/// that are not UTF-8 become U+FFFD \param extras_json a JSON object stored as the mesh's extras, or empty
/// \throws FileError when it cannot be written \throws MeshError when the mesh is inconsistent or has no
/// triangles, or a position is not finite as a float \throws ParameterError when extras_json is not a JSON
/// object
void write_glb(const std::string& path, const Mesh& mesh, const std::string& name,
               const std::string& extras_json = {});

/// Points read from a file.
struct PointFile {
  PointCloud cloud;  ///< every point or vertex of the file, in its order
  /// For each vertex of a mesh, the first vertex at the same position (within 1e-6 of the diagonal), which
  /// may be itself; `unused` if no triangle uses it. Empty if there are no triangles.
  std::vector<std::uint32_t> place;
  static constexpr std::uint32_t unused = 0xffffffff;
  /// The location of the first position that is not finite: "line 7", "vertex 3" (from 0). Empty if all are
  /// finite.
  std::string first_not_finite;
  std::string note;  ///< one line about ignored columns; usually empty
};

/// The distinct measurements: the first point at each position. Vertices at the same position are one
/// measurement that was split for its attributes.
PointCloud distinct_points(const PointFile& file);

/// Reads sampled points, in the order of the file. The extension determines the format:
///   .xyz .txt .csv .tsv  a point per line, columns between semicolons, else commas, else blanks or tabs (the
///   .asc .pts            first line decides), in quotes or not. A first line of one whole number is how many
///                        points follow. A header, which begins with a name or an
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
/// Other names of columns: position_x ..., normal_x ..., s t, texture_u texture_v. Empty lines and lines that
/// begin with # are skipped. NaN and infinities are kept.
///
/// Numbers are read in double, correctly rounded (glTF: float, as stored). Tables, PLY and PCD are read in
/// pieces: memory is at most three times the cloud. A count the file states is checked against what it holds.
/// \param progress called from time to time with the fraction read
/// \throws FileError naming the file, its line or vertex, what is expected there and what it has; at least
/// one point is expected
PointFile read_points(const std::string& path, const std::function<void(double)>& progress = {},
                      const ReadOptions& options = {});

/// Whether a path names standard output: "-", /dev/stdout, /dev/fd/1 or a link to one of them.
bool is_standard_output(const std::string& path);

/// A file that is written piece by piece, but appears completely or not at all. It has no name until
/// commit(), so an existing file stays until the new one is complete. Without commit() nothing remains. If
/// the file system does not support unnamed files (O_TMPFILE), the content is in a hidden file next to the
/// target until commit() (.darboux-*.tmp), which remains if the process is killed.
///
/// An existing file is replaced: its mode is kept, and its owner and group where permitted; other hard links
/// keep the old content; a symbolic link stays, and its target is replaced or created. A read-only file is an
/// error. A path that names a descriptor of this process ("-" is standard output, /dev/stdout, /dev/fd/N), a
/// device or a pipe is written to directly, at its current position.
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
  /// Whether the path names a descriptor of this process that is an open regular file. Other readers of this
  /// file see each write.
  bool is_written_in_place() const;

 private:
  void flush();
  void give_name();
  bool link_name();  // false where the file system gives it none
  void copy_to_temporary();
  void rename_temporary();
  std::string path_;       // as messages name it
  std::string target_;     // the file to replace; empty if descriptor_ is the target itself
  std::string temporary_;  // the hidden name, while there is one
  std::string buffer_;
  int descriptor_ = -1;
};

/// Writes a whole file at once, as OutputFile does. \throws FileError
void write_file(const std::string& path, std::string_view content);

/// Reads a surface from its formula in a text file, over u and v in [0, 1], both linear:
///
///     # the catenoid
///     a = 2                          # radius of the neck; length
///     t = 2*v - 1
///     x = a*cosh(t)*cos(2*pi*u)
///     y = a*cosh(t)*sin(2*pi*u)
///     z = a*t
///
/// One definition per line, in any order; # begins a comment. x, y and z are the position. A name whose
/// expression contains only numbers and pi is a parameter, with a double as value and its comment as
/// description; any other name is an abbreviation. Operators, strongest first: ^ (from the right), + and - as
/// signs, * and /, + and -, comparisons, &&, ||, condition ? a : b. Functions: sin cos tan asin acos atan
/// atan2(y, x), sinh cosh tanh asinh acosh atanh, sqrt exp, log and ln (natural), pow(a, b), abs sign, min(a,
/// b) max(a, b), and sin_turns(t), cos_turns(t): sine and cosine of 2πt with exact range reduction, so that
/// quarter turns are exact and u + 1 gives the bits of u.
///
/// The file is parsed once, and the expression can be evaluated for any scalar type. So the partials come
/// from nested dual numbers, accurate to rounding, and the laws of testing.h apply as to a C++ type. pi has
/// the precision of the scalar; a number in the text is the nearest double. A power with a constant integer
/// exponent up to 1024 is computed as a product, so it accepts negative bases; other powers require positive
/// bases. Where the formula is undefined (log of a negative number, 0/0), it gives NaN or infinity with
/// status `no_frame` and `overflow`, and `check` reports it. Singular points and self-intersections cannot be
/// declared: seams are edges, and poles are detected only where a partial is exactly zero.
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

/// Reads a surface of one of these kinds from a JSON object. Unknown keys are an error.
///   bezier-patch            points, weights, degree_u, degree_v
///   bspline-patch           points, weights, degree_u, degree_v, knots_u, knots_v
///   surface-of-revolution   points, weights, degree, knots: the profile
/// A patch's points are rows [[[x, y, z], ...], ...]: row i holds P_i0, P_i1, ..., so u runs from row to row
/// and v along each. A profile's points are [[ρ, z], ...]. weights: rows of positive numbers as the points,
/// all 1 when missing. Degrees are 1 to 15. Those of bezier-patch follow from the points, and must agree if
/// given; that of a profile is 1 (a polyline) by default. knots: points + degree + 1 numbers, non-decreasing,
/// none more than degree + 1 times; by default clamped and equally spaced. Knots are mapped to [0, 1].
/// \throws FileError naming file, key and what is expected there \throws ParameterError for another kind
AnySurface read_surface_file(std::string_view kind, const std::string& path);

}  // namespace darboux
