// Assesses every primitive of a file, as `darboux validate` does. Exit status: 0 pass, 1 not, 2 unreadable.
#include <cstdio>

#include <darboux/assess.h>
#include <darboux/error.h>
#include <darboux/io.h>

int main(int argc, char** argv) try {
  if (argc != 2) throw darboux::ParameterError("assess_a_mesh", "needs the file of a mesh");
  darboux::AssessOptions options;
  options.max_angle_deg = 2;  // for interior corners; three times that elsewhere
  options.surface = darboux::parse_specification("torus");  // leave it out to have the surface recognised
  int status = 0;
  for (const darboux::Primitive& primitive : darboux::read_asset(argv[1]).primitives)
    for (const darboux::Assessment& assessment : darboux::assess_parts(primitive.data, options)) {
      const darboux::MeshReport& report = assessment.report;
      const auto convention = static_cast<std::size_t>(report.handedness.convention);
      if (assessment.fit && assessment.fit->fits)
        std::printf("%zu corners, w %s\n", report.corners,
                    std::string(darboux::handedness_convention_names[convention]).c_str());
      for (const darboux::ClassReport& c : report.classes)
        if (c.tangent_deg)
          std::printf(
              "%-10s tangent rms %.3g deg\n",
              std::string(darboux::vertex_class_names[static_cast<std::size_t>(c.vertex_class)]).c_str(),
              c.tangent_deg->rms);
      for (const darboux::Finding& f : report.findings)
        std::printf("%s (%zu): %s\n", std::string(f.code).c_str(), f.count, f.message.c_str());
      const auto verdict = static_cast<std::size_t>(report.verdict);
      std::printf("%s\n", std::string(darboux::verdict_names[verdict]).c_str());
      if (report.verdict > darboux::Verdict::pass) status = 1;
    }
  return status;
} catch (const darboux::Error& e) {
  std::fprintf(stderr, "%s\n", e.what());
  return 2;
}
