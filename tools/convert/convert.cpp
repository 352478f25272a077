// SPDX-License-Identifier: BSD-3-Clause
#include "tools/convert/convert.hpp"

#include <algorithm>
#include <stdexcept>

#include "common/graph/output_files.hpp"

namespace clearway::convert {
namespace {

const char* NameOf(Format format) {
  switch (format) {
    case Format::kLvx:
      return "an LVX file";
    case Format::kLog:
      return "an LCM log";
    case Format::kFolder:
      break;
  }
  return "a folder of scans";
}

// Packets are all of one kind for each sensor: what its scans ask for is found first.
std::vector<Packing> FindPackings(const SourceSettings& settings) {
  const std::unique_ptr<SliceSource> source = OpenSource(settings);
  std::vector<Packing> packings(source->sensors().size(), Packing::kSingle);
  ScanCollector collector(packings.size());
  const auto look = [&packings](const std::vector<CollectedScan>& scans) {
    for (const CollectedScan& scan : scans) {
      Packing& packing = packings[static_cast<std::size_t>(scan.sensor)];
      packing = std::max(packing, PackingFor(scan));
      // What does not fit is refused before the output is touched.
      if (packing == Packing::kDense) static_cast<void>(PacketPacker(packing).Add(scan));
    }
  };
  while (const auto slice = source->Next()) look(collector.Add(*slice));
  look(collector.Finish());
  return packings;
}

std::unique_ptr<SliceSink> MakeSink(const Settings& settings, const SliceSource& source) {
  switch (FormatOf(settings.output)) {
    case Format::kLvx:
      return MakeLvxSink(settings.output, source.sensors(), FindPackings(settings.source));
    case Format::kFolder:
      return MakeFolderSink(settings.output, source.sensors());
    case Format::kLog:
      break;
  }
  return MakeLogSink(settings.output, source.sensors(), settings.source.channel_prefix);
}

void Refuse(const Settings& settings) {
  const Format from = FormatOf(settings.source.input);
  if (from == FormatOf(settings.output)) {
    throw std::runtime_error(settings.source.input.string() + " and " + settings.output.string() +
                             " are both " + NameOf(from) + ": there is nothing to convert");
  }
  if (!std::filesystem::exists(settings.source.input)) {
    throw std::runtime_error(settings.source.input.string() + ": no such file or folder");
  }
  graph::RefuseToOverwrite({settings.output}, {settings.source.input});
}

}  // namespace

Report Convert(const Settings& settings, const std::function<void(double)>& on_progress) {
  Refuse(settings);
  const std::unique_ptr<SliceSource> source = OpenSource(settings.source);
  const std::unique_ptr<SliceSink> sink = MakeSink(settings, *source);
  while (const auto slice = source->Next()) {
    sink->Take(*slice);
    on_progress(source->progress());
  }
  return {.from = FormatOf(settings.source.input),
          .to = FormatOf(settings.output),
          .read = source->counts(),
          .written = sink->Finish()};
}

std::string Describe(const Report& report) {
  const auto text = [](std::int64_t count, const char* what) {
    return std::to_string(count) + what;
  };
  std::string line =
      text(report.written.scans, " scans, ") + text(report.written.points, " points");
  if (report.from == Format::kLvx) line += ", " + text(report.read.packets, " packets read");
  if (report.to == Format::kLvx) line += ", " + text(report.written.packets, " packets written");
  line += ", " + text(report.read.lost_packets, " packets lost, ") +
          text(report.read.zero_returns, " zero returns");
  if (report.read.left_out > 0) line += ", " + text(report.read.left_out, " inputs left out");
  if (report.written.unused > 0) line += ", " + text(report.written.unused, " slices left out");
  if (report.written.unwritable > 0) {
    line += ", " + text(report.written.unwritable, " points that packets cannot hold");
  }
  return line;
}

}  // namespace clearway::convert
