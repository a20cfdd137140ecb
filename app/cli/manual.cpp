// Help texts, the man page and shell completions for bash, zsh and fish, generated from the CLI11
// app.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "app/cli/program.hpp"
#include "core/model/error.hpp"
#include "core/model/text.hpp"
#include "core/planes/pipeline/options_table.hpp"
#include "core/report/data/report_data.hpp"

namespace planescope::app {
namespace {

constexpr std::size_t kHelpWidth = 80;
constexpr std::pair<int, const char*> kExitCodes[] = {
    {0, "success"},
    {1, "a comparison failed"},
    {2, "bad input or usage"},
    {3, "no display or rendering failed (data files are still written)"},
    {130, "canceled"}};

std::string replaced(const std::string& text, std::string_view what, std::string_view by) {
  std::string result;
  std::size_t from = 0;
  for (std::size_t at; (at = text.find(what, from)) != std::string::npos; from = at + what.size())
    result.append(text, from, at - from).append(by);
  return result.append(text, from);
}

std::vector<const CLI::App*> subcommands(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App*) { return true; });
}

/// An option as shown in help texts.
struct OptionText {
  std::vector<std::string> names;    // "-o", "--out"; empty for a positional
  std::string type;                  // "DIR"; empty for a flag or an untyped positional
  std::string help;                  // on one line
  std::vector<std::string> choices;  // allowed values
  bool is_file = false, is_folder = false;
};

/// Joins the lines as sentences.
std::string on_one_line(const std::string& text) {
  return fmt::format("{}", fmt::join(split(text, '\n'), text.ends_with('.') ? ". " : "; "));
}

/// Wraps lines at column 80; each line starts at column `indent`.
std::string wrapped(const std::string& text, std::size_t indent) {
  std::string out;
  for (const std::string& line : split(text, '\n')) {
    std::size_t column = indent;
    if (!out.empty()) out += '\n' + std::string(indent, ' ');
    for (const std::string& word : split(line, ' ')) {
      if (column > indent && column + 1 + word.size() > kHelpWidth) {
        out += '\n' + std::string(indent, ' ');
        column = indent;
      } else if (column > indent) {
        out += ' ';
        ++column;
      }
      out += word;
      column += word.size();
    }
  }
  return out;
}

class HelpFormat : public CLI::Formatter {
 public:
  HelpFormat() {
    label("SUBCOMMAND", "COMMAND");
    label("REQUIRED", "(required)");
  }

  std::string make_help(const CLI::App* app,
                        std::string name,
                        CLI::AppFormatMode mode) const override {
    const std::string text = CLI::Formatter::make_help(app, name, mode);
    return replaced(text, "\n\n\n", "\n\n");
  }

  std::string make_description(const CLI::App* app) const override {
    const std::string& text = app->get_description();
    const std::size_t end = text.find('\n');
    if (end == std::string::npos) return wrapped(text, 0) + "\n\n";
    return wrapped(text.substr(0, end) + "." + text.substr(end), 0) + "\n\n";
  }

  std::string make_option(const CLI::Option* option, bool is_positional) const override {
    return row(make_option_name(option, is_positional) + make_option_opts(option),
               option->get_description());
  }

  std::string make_subcommand(const CLI::App* command) const override {
    const std::string& text = command->get_description();
    return row(command->get_name(), text.substr(0, text.find('\n')));
  }

  std::string make_footer(const CLI::App* app) const override {
    const std::string more =
        fmt::format("Run `{} help COMMAND` for the options of a command.\n", app->get_name());
    std::vector<std::string> codes;
    for (const auto& [code, meaning] : kExitCodes)
      codes.push_back(fmt::format("{} {}", code, meaning));
    return (app->get_parent() ? "" : more) +
           wrapped(fmt::format("Exit codes: {}.", fmt::join(codes, ", ")), 0) + "\n";
  }

 private:
  static std::string row(const std::string& name, const std::string& text) {
    constexpr std::size_t kIndent = 26;
    const std::string gap = name.size() + 3 > kIndent ? '\n' + std::string(kIndent, ' ')
                                                      : std::string(kIndent - 2 - name.size(), ' ');
    return "  " + name + gap + wrapped(text, kIndent) + '\n';
  }
};

/// Literal alternatives of a type such as "gcn|pca|truth|FILE".
std::vector<std::string> choices_of(const std::string& type) {
  std::vector<std::string> choices;
  for (const std::string& part : split(type, '|')) {
    const bool literal = !part.empty() && std::ranges::all_of(part, [](unsigned char c) {
      return std::islower(c) || std::isdigit(c) || c == '-';
    });
    if (literal) choices.push_back(part);
  }
  return choices;
}

OptionText text_of(const CLI::Option& option) {
  OptionText text;
  for (const std::string& name : option.get_snames())
    text.names.push_back(fmt::format("-{}", name));
  for (const std::string& name : option.get_lnames())
    text.names.push_back(fmt::format("--{}", name));
  const bool is_switch = option.get_items_expected_max() == 0 || option.get_type_size_max() == 0;
  if (!is_switch) text.type = option.get_type_name();
  text.help = on_one_line(option.get_description());
  text.choices = choices_of(text.type);
  if (text.type == "NAME=VALUE")
    for (const planes::OptionInfo& info : planes::option_table())
      text.choices.push_back(info.name + "=");
  text.is_folder = text.type.find("DIR") != std::string::npos;
  text.is_file = text.type.find("FILE") != std::string::npos || text.names.empty();
  return text;
}

/// A command. The program itself comes first, then commands in the order of --help.
struct CommandText {
  std::string path;  // "labels export"; empty for the program
  std::string help;  // on one line
  std::vector<OptionText> options;
  std::vector<OptionText> positionals;
  std::vector<std::pair<std::string, std::string>> commands;  // subcommands: names and help
};

void add_commands(const CLI::App& app, const std::string& path, std::vector<CommandText>& texts) {
  CommandText text{path, on_one_line(app.get_description()), {}, {}, {}};
  for (const CLI::Option* option : app.get_options())
    (option->get_positional() ? text.positionals : text.options).push_back(text_of(*option));
  for (const CLI::App* command : subcommands(app))
    text.commands.emplace_back(command->get_name(), on_one_line(command->get_description()));
  texts.push_back(std::move(text));
  for (const CLI::App* command : subcommands(app))
    add_commands(*command, (path.empty() ? "" : path + " ") + command->get_name(), texts);
}

std::vector<CommandText> commands_of(const CLI::App& app) {
  std::vector<CommandText> texts;
  add_commands(app, "", texts);
  for (CommandText& text : texts) {  // words that may follow
    if (text.path == "help") text.commands = texts[0].commands;
    if (text.path == "options")
      for (const planes::OptionInfo& info : planes::option_table())
        text.commands.emplace_back(info.name, info.meaning);
  }
  return texts;
}

/// Shortens a help text to its first sentence, for lists.
std::string first_sentence(const std::string& text) {
  for (const std::string_view end : {": ", "; ", ". "})
    if (const std::size_t at = text.find(end); at != std::string::npos)
      return first_sentence(text.substr(0, at));
  return text;
}

// man: roff(7) with the macros of man(7).

std::string roff(std::string text) {
  text = replaced(replaced(replaced(text, "\\", "\\e"), "-", "\\-"), "'", "\\(aq");
  return text.starts_with('.') ? fmt::format("\\&{}", text) : text;
}

std::string roff_options(const std::vector<OptionText>& options) {
  std::string text;
  for (const OptionText& option : options) {
    std::vector<std::string> names;
    for (const std::string& name : option.names)
      names.push_back(fmt::format("\\fB{}\\fR", roff(name)));
    text += fmt::format(".TP\n{}", fmt::join(names, ", "));
    if (!option.type.empty()) text += fmt::format(" \\fI{}\\fR", roff(option.type));
    text += "\n" + roff(option.help) + "\n";
  }
  return text;
}

/// Returns the description without the program's name, up to the first comma: "finds planes in
/// depth recordings".
std::string what_it_does(const std::string& name, const std::string& about) {
  const std::string does = about.starts_with(name + " ") ? about.substr(name.size() + 1) : about;
  return does.substr(0, does.find_first_of(",;:."));
}

std::string man_page(const CLI::App& app) {
  const std::string& name = app.get_name();
  const std::vector<CommandText> commands = commands_of(app);
  std::string text =
      fmt::format(".TH {} 1 \"\" \"planescope {}\" \"User Commands\"\n.SH NAME\n{} \\- {}\n",
                  replaced(name, "-", "\\-"), report::build_info().version, roff(name),
                  roff(what_it_does(name, commands[0].help)));
  text += fmt::format(
      ".SH SYNOPSIS\n.B {}\n[\\fICOMMAND\\fR] [\\fIOPTIONS\\fR] [\\fIINPUT\\fR...]\n", roff(name));
  text += ".SH DESCRIPTION\n" + roff(commands[0].help) + "\n";
  text += ".SH OPTIONS\n" + roff_options(commands[0].options);
  text += ".SH COMMANDS\n";
  for (const CommandText& command : commands) {
    if (command.path.empty()) continue;
    text += fmt::format(".SS {} {}", roff(name), roff(command.path));
    for (const OptionText& positional : command.positionals)
      text += " " + roff(positional.type.empty() ? "INPUT..." : positional.type);
    text += "\n" + roff(command.help) + "\n" + roff_options(command.options);
  }
  text += ".SH EXIT STATUS\n";
  for (const auto& [code, meaning] : kExitCodes)
    text += fmt::format(".TP\n.B {}\n{}\n", code, meaning);
  return text;
}

// Shell completions. In all shells the command is the longest command path among the words typed so
// far.

std::string in_quotes(const std::string& text) {
  return fmt::format("'{}'", replaced(text, "'", "'\\''"));
}

std::string identifier(std::string name) {
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

/// Quotes every command path except the program's own.
std::string paths_in_quotes(const std::vector<CommandText>& commands) {
  std::vector<std::string> paths;
  for (const CommandText& command : commands)
    if (!command.path.empty()) paths.push_back(in_quotes(command.path));
  return fmt::format("{}", fmt::join(paths, " "));
}

std::string bash_completions(const CLI::App& app) {
  const std::vector<CommandText> commands = commands_of(app);
  const std::string function = "_" + identifier(app.get_name());
  std::string text = fmt::format(
      "# bash completion for {0}, as `{0} completions bash` prints it\n\n"
      "{1}() {{\n"
      "  local cur=$2 prev=$3 path= word i options= commands= values= files= paths=({2})\n"
      "  for ((i = 1; i < COMP_CWORD; ++i)); do\n"
      "    for word in \"${{paths[@]}}\"; do\n"
      "      if [ \"$word\" = \"${{path:+$path }}${{COMP_WORDS[i]}}\" ]; then path=$word && break; "
      "fi\n"
      "    done\n"
      "  done\n"
      "  if [ \"$prev\" = = ]; then return; fi  # the value of --set NAME=\n"
      "  case $path in\n",
      app.get_name(), function, paths_in_quotes(commands));
  for (const CommandText& command : commands) {
    std::vector<std::string> names, options;
    for (const auto& [name, help] : command.commands) names.push_back(name);
    std::string cases;
    for (const OptionText& option : command.options) {
      options.insert(options.end(), option.names.begin(), option.names.end());
      if (option.type.empty()) continue;
      cases += fmt::format("        {}) values={} files={} ;;\n", fmt::join(option.names, " | "),
                           in_quotes(fmt::format("{}", fmt::join(option.choices, " "))),
                           option.is_folder ? "d"
                           : option.is_file ? "f"
                                            : "none");
    }
    text += fmt::format("    {})\n      options={} commands={}\n", in_quotes(command.path),
                        in_quotes(fmt::format("{}", fmt::join(options, " "))),
                        in_quotes(fmt::format("{}", fmt::join(names, " "))));
    if (!cases.empty()) text += fmt::format("      case $prev in\n{}      esac\n", cases);
    text += "      ;;\n";
  }
  text += fmt::format(
      "  esac\n"
      "  if [ -n \"$files\" ]; then\n"
      "    mapfile -t COMPREPLY < <(compgen -W \"$values\" -- \"$cur\")\n"
      "    case $values in *=*) compopt -o nospace ;; esac\n"
      "  elif [[ $cur == -* ]]; then\n"
      "    mapfile -t COMPREPLY < <(compgen -W \"$options\" -- \"$cur\")\n"
      "    return\n"
      "  else\n"
      "    mapfile -t COMPREPLY < <(compgen -W \"$commands\" -- \"$cur\")\n"
      "    files=f\n"
      "  fi\n"
      "  case $files in\n"
      "    f) mapfile -t -O ${{#COMPREPLY[@]}} COMPREPLY < <(compgen -f -- \"$cur\") && compopt -o "
      "filenames ;;\n"
      "    d) mapfile -t -O ${{#COMPREPLY[@]}} COMPREPLY < <(compgen -d -- \"$cur\") && compopt -o "
      "filenames ;;\n"
      "  esac\n"
      "}}\n"
      "complete -F {} {}\n",
      function, app.get_name());
  return text;
}

std::string zsh_completions(const CLI::App& app) {
  const std::vector<CommandText> commands = commands_of(app);
  // Brackets and colons are special in _arguments specifications.
  const auto plain = [](const std::string& text) {
    return replaced(replaced(replaced(text, "[", "("), "]", ")"), ":", "\\:");
  };
  std::string text = fmt::format(
      "#compdef {0}\n"
      "# zsh completion for {0}, as `{0} completions zsh` prints it\n\n"
      "local at= word i\n"
      "local -a paths commands\n"
      "paths=({1})\n"
      "for ((i = 2; i < CURRENT; ++i)); do\n"
      "  word=\"${{at:+$at }}${{words[i]}}\"\n"
      "  if (( ${{paths[(Ie)$word]}} )); then at=$word; fi\n"
      "done\n"
      "case $at in\n",
      app.get_name(), paths_in_quotes(commands));
  for (const CommandText& command : commands) {
    text += fmt::format("  {})\n", in_quotes(command.path));
    std::vector<std::string> names;
    for (const auto& [name, help] : command.commands)
      names.push_back(in_quotes(fmt::format("{}:{}", name, plain(first_sentence(help)))));
    text += fmt::format("    commands=({})\n    _arguments -S", fmt::join(names, " "));
    for (const OptionText& option : command.options)
      for (const std::string& name : option.names) {
        std::string spec = fmt::format("*{}[{}]", name, plain(first_sentence(option.help)));
        if (!option.type.empty()) {
          spec += fmt::format(":{}:", plain(option.type));
          if (option.is_folder)
            spec += "_files -/";
          else if (option.is_file && option.choices.empty())
            spec += "_files";
          else if (option.is_file)
            spec += fmt::format("{{ compadd {}; _files }}", fmt::join(option.choices, " "));
          else if (option.type == "NAME=VALUE")
            spec += fmt::format("{{ compadd -S \"\" {} }}", fmt::join(option.choices, " "));
          else
            spec += fmt::format("({})", fmt::join(option.choices, " "));
        }
        text += " \\\n      " + in_quotes(spec);
      }
    text += names.empty()
                ? " \\\n      '*:input:_files'\n    ;;\n"
                : " \\\n      '*:command:{ _describe command commands; _files }'\n    ;;\n";
  }
  return text + "esac\n";
}

std::string fish_completions(const CLI::App& app) {
  const std::vector<CommandText> commands = commands_of(app);
  const std::string& name = app.get_name();
  const std::string function = "__" + identifier(name) + "_at";
  const auto word = [](const std::string& text) {
    return fmt::format("'{}'", replaced(replaced(text, "\\", "\\\\"), "'", "\\'"));
  };
  std::string text = fmt::format(
      "# fish completion for {0}, as `{0} completions fish` prints it\n\n"
      "function {1} --description 'Whether the command typed so far is this one'\n"
      "    set -l at ''\n"
      "    for typed in (commandline -opc)[2..-1]\n"
      "        set -l longer (string trim \"$at $typed\")\n"
      "        if contains -- $longer {2}\n"
      "            set at $longer\n"
      "        end\n"
      "    end\n"
      "    test \"$at\" = \"$argv[1]\"\n"
      "end\n\n",
      name, function, paths_in_quotes(commands));
  for (const CommandText& command : commands) {
    const std::string here =
        fmt::format("complete -c {} -n \"{} '{}'\"", name, function, command.path);
    for (const auto& [below, help] : command.commands)
      text += fmt::format("{} -a {} -d {}\n", here, below, word(first_sentence(help)));
    for (const OptionText& option : command.options) {
      text += here;
      for (const std::string& given : option.names)
        text += given.starts_with("--") ? " -l " + given.substr(2) : " -s " + given.substr(1);
      if (!option.type.empty()) {
        text += option.is_file ? " -r" : " -x";
        if (option.is_folder)
          text += " -a '(__fish_complete_directories)'";
        else if (!option.choices.empty())
          text += " -a " + word(fmt::format("{}", fmt::join(option.choices, " ")));
      }
      text += " -d " + word(first_sentence(option.help)) + "\n";
    }
  }
  return text;
}

struct PrintArgs {
  std::vector<std::string> words;  // after `help`
  std::string shell, text;
};

int print(const PrintArgs& args, std::stop_token) {
  fmt::print("{}", args.text);
  return 0;
}

}  // namespace

std::shared_ptr<CLI::FormatterBase> help_format() { return std::make_shared<HelpFormat>(); }

void define_help(CLI::App& app, Line& line) {
  CLI::App* help = app.add_subcommand("help", "Print the help of a command");
  const auto args = std::make_shared<PrintArgs>();
  help->add_option("COMMAND", args->words, "Command, such as " + subcommands(app)[0]->get_name())
      ->type_name("");
  runs(help, line, args, print, [args, &app] {
    const CLI::App* at = &app;
    std::string path = app.get_name();
    for (const std::string& word : args->words) {
      std::vector<std::string> names;
      for (const CLI::App* command : subcommands(*at)) names.push_back(command->get_name());
      const auto found = std::ranges::find(names, word);
      if (found == names.end()) {
        const std::string near = nearest_name(word, names);
        throw Error(fmt::format("help: unknown command '{} {}'{}", path, word,
                                names.empty() ? "; expected no more arguments"
                                : near.empty()
                                    ? fmt::format("; expected one of {}", fmt::join(names, ", "))
                                    : fmt::format("; did you mean '{}'?", near)));
      }
      at = subcommands(*at)[static_cast<std::size_t>(found - names.begin())];
      path += " " + word;
    }
    args->text = app.get_formatter()->make_help(at, path, CLI::AppFormatMode::Normal);
  });
}

void define_man(CLI::App& app, Line& line) {
  CLI::App* man =
      app.add_subcommand("man", "Print the manual: " + app.get_name() + " man | man -l -");
  const auto args = std::make_shared<PrintArgs>();
  runs(man, line, args, print, [args, &app] { args->text = man_page(app); });
}

void define_completions(CLI::App& app, Line& line) {
  CLI::App* completions =
      app.add_subcommand("completions", "Print completions for a shell\nBash: eval \"$(" +
                                            app.get_name() + " completions bash)\".");
  const auto args = std::make_shared<PrintArgs>();
  completions->add_option("SHELL", args->shell, "bash, zsh, or fish")
      ->type_name("")
      ->required()
      ->check(some_of({"bash", "zsh", "fish"}, "a supported shell"));
  runs(completions, line, args, print, [args, &app] {
    args->text = args->shell == "bash"  ? bash_completions(app)
                 : args->shell == "zsh" ? zsh_completions(app)
                                        : fish_completions(app);
  });
}

}  // namespace planescope::app
