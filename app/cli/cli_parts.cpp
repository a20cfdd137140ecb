#include "app/cli/cli_parts.hpp"

#include <CLI/CLI.hpp>
#include <sstream>

#include "core/model/text.hpp"

namespace planescope::app {

// CLI11 prints descriptions as they are: broken here, so that they fit beside the names.
std::string wrapped(const std::string& text) {
  constexpr std::size_t kWidth = 62;
  std::string out;
  std::size_t column = 0;
  std::istringstream words(text);
  for (std::string word; words >> word; column += word.size() + 1) {
    if (column > 0 && column + word.size() > kWidth) {
      out += '\n';
      column = 0;
    } else if (column > 0) {
      out += ' ';
    }
    out += word;
  }
  return out;
}

CLI::Option* add(CLI::App* command,
                 const std::string& names,
                 std::string& value,
                 const std::string& type,
                 const std::string& help) {
  return command->add_option(names, value, wrapped(help))->type_name(type);
}

void add_inputs(CLI::App* command, Typed& t, const std::string& what) {
  command->add_option("INPUT", t.inputs, what)->type_name("");
  const auto option = [&](const char* name, std::string& value, const char* type,
                          const char* help) {
    add(command, name, value, type, help)->group("Recordings");
  };
  option("--frames", t.frames, "A:B:STEP",
         "Which frames, as Python slices a list: 0:100:10, -5:, or 7");
  option("--intrinsics", t.intrinsics, "FX,FY,CX,CY",
         "Of the depth image, in pixels; wins over what the files say");
  option("--depth-unit", t.depth_unit, "METRES",
         "Metres per depth count; wins over what the files say");
  option("--instance-field", t.instance_field, "NAME",
         "Of clouds: the field with true plane ids, whole numbers from 1, instead of `instance`");
  option("--labels", t.labels, "DIR", "Ground truth; otherwise <recording>.labels beside it");
}

// What becomes of a frame before its points are labelled.
void add_clouds(CLI::App* command, Typed& t) {
  const auto option = [&](const char* name, std::string& value, const char* type,
                          const char* help) {
    add(command, name, value, type, help)->group("Method");
  };
  option("--profile", t.profile, "paper|paper-closest|refined",
         "Where the options' values come from; default refined");
  command
      ->add_option("--set", t.set,
                   wrapped("Any option by its name, after the profile; `planescope options` lists "
                           "them. May be given many times"))
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false)
      ->group("Method");
  option("--gravity", t.gravity, "auto|X,Y,Z|imu|estimate|none",
         "Direction in which things fall, in the sensor's own frame (x right, y down, z forward; "
         "clouds: the file's axes). auto, the default, takes the first that exists: the "
         "recording's own, its IMU, a floor that was picked in the window, an estimate from the "
         "scene. none finds planes of any direction without telling h from v");
  option("--max-range", t.max_range, "M",
         "Crop what is farther: depth z of depth frames (default 1.5), distance from the origin of "
         "clouds (default none)");
  option("--voxel", t.voxel, "M", "Edge of the voxel grid, default 0.02; 0 = none");
  option("--threads", t.threads, "N",
         "Default: all cores. The results are the same for any number");
}

void add_method(CLI::App* command, Typed& t) {
  add_clouds(command, t);
  const auto option = [&](const char* name, std::string& value, const char* type,
                          const char* help) {
    add(command, name, value, type, help)->group("Method");
  };
  option(
      "--classifier", t.classifier, "gcn|pca|truth|FILE",
      "What labels points h or v: the network that comes with planescope (default), PCA normals, "
      "ground truth, or a network of your own (.safetensors)");
  std::string methods;
  for (const planes::Method method : planes::built_methods())
    methods += method == planes::Method::ours ? "ours (default)"
                                              : std::string(", ") + planes::to_string(method);
  add(command, "--method", t.method, "NAME", "What finds the planes: " + methods)->group("Method");
}

void add_json(CLI::App* command, Typed& t) {
  command->add_flag("--json", t.json, "Print JSON instead of text");
}

void add_out(CLI::App* command, Typed& t) {
  add(command, "-o,--out", t.out, "DIR", "Output folder; made where it is missing");
}

// The command that was typed last: `synth stairs` is the app of `stairs`.
const CLI::App* innermost(const CLI::App* app) {
  while (!app->get_subcommands().empty()) app = app->get_subcommands().front();
  return app;
}

std::vector<std::string> subcommand_names(const CLI::App* app) {
  std::vector<std::string> names;
  for (const CLI::App* sub : app->get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(sub->get_name());
  return names;
}

// One line for what CLI11 did not understand, with the name that was probably meant.
std::string message_of(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App* command = innermost(&app);
  const std::vector<std::string> extras = app.remaining(true);
  if (extras.empty()) {
    std::string text = error.what();
    return text.substr(0, text.find('\n'));
  }
  const std::string& word = extras.front();
  const bool is_option = word.size() > 1 && word[0] == '-';
  std::vector<std::string> names;
  if (is_option) {
    for (const CLI::Option* option : command->get_options())
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  } else {
    names = subcommand_names(command);
  }
  const std::string given = word.substr(0, word.find('='));
  const std::string near = nearest_name(given, names);
  std::string text = is_option       ? "unknown option '" + given + "'"
                     : names.empty() ? "unexpected argument '" + given + "'"
                                     : "unknown command '" + given + "'";
  if (!near.empty()) return text + ", did you mean '" + near + "'?";
  std::string path;
  for (; command != &app; command = command->get_parent()) path = " " + command->get_name() + path;
  return text + ", see planescope" + path + " --help";
}

}  // namespace planescope::app
