// The command line: subcommands, options, help, exit codes.
#pragma once

namespace rend {

/// Runs one rend command. Exit codes: 0 done, 1 something of ours failed, 2 bad input, 4 the run stopped with a
/// named numerical reason.
int run_command_line(int argc, char** argv);

}  // namespace rend
