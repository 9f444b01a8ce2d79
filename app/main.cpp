// Entry point of the rend program.
#include "app/command_line.h"

int main(int argc, char** argv) { return rend::run_command_line(argc, argv); }
