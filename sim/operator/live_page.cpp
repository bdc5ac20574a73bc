// SPDX-License-Identifier: Apache-2.0
#include "sim/operator/live_page.hpp"

#include <stdexcept>
#include <utility>

#include "firmware/host/config/share_folder.hpp"
#include "firmware/host/report/report.hpp"
#include "sim/operator/desk.hpp"

namespace fovea::sim {

LivePage::LivePage(live::ServerConfig config, const RunDescription& about) {
  config.report = [this] { return Report(); };
  live::Catalogue catalogue = OperatorDesk::Offer(about);
  catalogue.channels = live::LogChannels(
      {.camera = about.scene.has_eye, .truth = about.scene.has_eye, .theory = about.theory.has_value()});
  server_ = std::make_unique<live::Server>(std::move(config), catalogue);
  feed_ = std::make_unique<live::LiveFeed>(*server_, catalogue.channels);
}

void LivePage::ShowLog(const std::filesystem::path& log) {
  const std::lock_guard lock(mutex_);
  log_ = log;
}

std::string LivePage::Report() {
  std::filesystem::path log;
  {
    const std::lock_guard lock(mutex_);
    log = log_;
  }
  if (log.empty()) {
    throw std::runtime_error("no run is in progress");
  }
  report::RunData run = report::ReadRun(log);
  run.source = log.filename().string();
  return report::ReportPage(config::ShareFolder() / "report").Make({run});
}

}  // namespace fovea::sim
