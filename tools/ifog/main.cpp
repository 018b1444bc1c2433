// ifog: the command line. Exit 0 good, 1 failed, 2 usage.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

#include "drivers/ifog/quoted.h"
#include "tools/ifog/commands.h"

int main(int argc, char** argv) {
  CLI::App app{"ifog: Allan analysis, denoising, diagnosis, replay and monitoring of fibre-optic gyros",
               "ifog"};
  app.require_subcommand(1);
  app.set_version_flag("--version", IFOG_VERSION);

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

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const ifog::tools::Failed&) {
    return 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "ifog: %s\n", ifog::printable(error.what(), ifog::kLongestMessage).c_str());
    return 1;
  }
  return 0;
}
