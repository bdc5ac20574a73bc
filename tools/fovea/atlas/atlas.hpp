// SPDX-License-Identifier: Apache-2.0
// fovea atlas: the convergence rate of simulated runs from random starts; with --faults, the outcome of every
// fault in every mode and stage; with --robustness, what wrong beliefs cost; with --contact, which pushes are
// detected; with --findings, whether what runs find out about wrong beliefs is true; with --laws, all visual
// laws on the same starts.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tools/fovea/atlas/rows.hpp"
#include "tools/fovea/robustness/spec.hpp"

namespace fovea {

struct AtlasArguments {
  std::string target;
  bool faults = false;
  bool robustness = false;
  bool contact = false;
  bool findings = false;
  bool laws = false;
  std::string truth;          // a specification; "": none, or the shipped one with --robustness
  std::vector<double> sizes;  // of all its differences
  bool tornado = false;
  bool margin = false;
  int alone = 3;  // starts of each quantity alone
  bool markdown = false;
  std::vector<std::string> only;
  std::optional<int> runs;
  int jobs = 0;  // 0: one for each core
  std::optional<int> seed;
  std::vector<std::string> assignments;
  std::string starts;  // file; "": random starts
  std::string out;
  bool resume = false;
  bool draw_only = false;
  std::string views;  // file to write; "": none
  bool json = false;
};

// Adds the subcommand, which fills `arguments`.
CLI::App* AddAtlas(CLI::App& app, AtlasArguments& arguments);

// Simulates the runs and prints the figures. Returns the program's exit code. Throws config::InputError.
int Atlas(const AtlasArguments& arguments);
// The same for --faults.
int FaultAtlas(const AtlasArguments& arguments);
// And for --contact.
int ContactAtlas(const AtlasArguments& arguments);
// And for --findings.
int FindingsAtlas(const AtlasArguments& arguments);
// And for --laws.
int LawsAtlas(const AtlasArguments& arguments);

// The number of runs in parallel; of starts.
int JobsOf(const AtlasArguments& arguments);
int RunsOf(const AtlasArguments& arguments);
// What is not as the servo believes, by --truth and --set. InputError: nothing is, or it cannot be read.
robustness::Spec TruthOf(const AtlasArguments& arguments);
// What all runs with `target` share. `truth`: assignments of [truth] from which all cases follow.
atlas::Heading HeadingOf(const AtlasArguments& arguments, const std::string& target,
                         const std::vector<std::string>& truth);

}  // namespace fovea
