// ifog: the command line. Exit 0 good, 1 failed, 2 usage.
#include <CLI/CLI.hpp>
#include <exception>
#include <sstream>
#include <string>

#include "drivers/ifog/driver.h"
#include "tools/ifog/commands.h"
#include "tools/ifog/console/say.h"
#include "tools/ifog/console/usage_error.h"

int main(int argc, char** argv) {
  ifog::tools::prepare_standard_streams();
  CLI::App app{"ifog: Allan analysis, denoising, diagnosis, replay and monitoring of fibre-optic gyros",
               "ifog"};
  app.require_subcommand(1);
  app.set_version_flag("--version",
                       "ifog " IFOG_VERSION " (driver interface " + std::to_string(IFOG_DRIVER_ABI) + ")");

  ifog::tools::add_allan(app);
  ifog::tools::add_compare(app);
  ifog::tools::add_convert(app);
  ifog::tools::add_denoise(app);
  ifog::tools::add_drivers(app);
  ifog::tools::add_monitor(app);
  ifog::tools::add_picture(app);
  ifog::tools::add_replay(app);
  ifog::tools::add_tune(app);

  ifog::tools::add_diagnose(app);
  ifog::tools::add_simulate(app);

  int status = 0;
  try {
    try {
      app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
      std::ostringstream out, complaint;  // --help and --version are errors to the parser, too
      status = app.exit(error, out, complaint) == 0 ? 0 : 2;
      ifog::tools::say("%s", out.str().c_str());
      if (status != 0) ifog::tools::warn("%s", ifog::tools::usage_error(app, argc, argv, error).c_str());
    } catch (const ifog::tools::Failed&) {
      status = 1;
    }
    ifog::tools::finish_saying();
  } catch (const std::exception& error) {
    ifog::tools::warn("ifog: %s\n", error.what());
    status = 1;
  }
  return status;
}
