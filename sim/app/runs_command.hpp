// SPDX-License-Identifier: Apache-2.0
// The command `fovea-sim runs`: many runs in one process, one after another. Shaders, the painted light and
// meshes of the bench are made once, which takes longer than a short run.
#pragma once

namespace fovea::sim {

inline constexpr const char* kRunsHelp =
    "Each line of standard input is a JSON object: \"run\", the words after `fovea-sim run`; \"out\" and "
    "\"err\", files for the run's standard output and standard error. After each run, a line with its exit "
    "code follows on standard output. The results are those of single runs.\n"
    "Example:\n"
    "  {\"run\": [\"ball\", \"--seed\", \"7\", \"--no-report\", \"--json\", \"--out\", \"out/7\"], \"out\": "
    "\"7.json\", \"err\": \"7.txt\"}";

// Simulates until standard input ends. Returns the program's exit code. InputError: a line that is no
// request, or a file that cannot be written.
int RunsCommand();

}  // namespace fovea::sim
