#include "app/desktop/jobs/map_jobs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <thread>

#include "app/desktop/actions/actions.hpp"
#include "app/desktop/tracks/map_view.hpp"
#include "core/model/error.hpp"
#include "core/model/text.hpp"
#include "core/world/files/map_files.hpp"

namespace planescope::desktop {

MapJobs::MapJobs(std::function<void(std::function<void(State&)>)> deliver,
                 std::function<void()> wake)
    : deliver_(std::move(deliver)), worker_(std::move(wake), [](const std::string&) {}) {}

MapJobs::~MapJobs() { worker_.cancel(); }

void MapJobs::pursue(State& state) {
  MapResults& results = state.results.map;
  if (asked_ && !results.running) {  // called off
    worker_.cancel();
    asked_ = false;
    ++number_;
  }
  const OpenRecording* open = state.document.current();
  if (!results.running || results.begun || !open) return;
  results.begun = asked_ = true;
  const int number = ++number_;
  worker_.cancel();
  worker_.replace([this, number, recording = open->recording, picked = open->picked,
                   options = state.document.options](std::stop_token stop) {
    const auto finish = [&](std::function<void(State&)> with) {
      deliver_([this, number, with = std::move(with)](State& s) {
        if (number != number_) return;
        asked_ = false;
        s.results.map.running = false;
        with(s);
      });
    };
    try {
      const auto classifier = tools_.classifier(options);
      const auto upright = io::with_picked_gravity(recording, picked);
      world::MapJob job;
      job.recording = upright.get();
      for (int i = 0; i < recording->frame_count(); ++i) job.frames.push_back(i);
      job.pipeline = options;
      job.classifier = classifier.get();
      job.threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()) - 1);
      job.stop = stop;
      job.progress = [&](const char* stage, int done, int all) {
        deliver_([this, number, stage, done, all](State& s) {
          if (number != number_) return;
          s.results.map.stage = stage;
          s.results.map.done = done;
          s.results.map.total = all;
        });
      };
      auto made = std::make_shared<MapView>();
      made->recording = recording;
      made->picked = picked;
      made->key = run_key(options);
      job.alone = true;  // the window shows how each frame finds its planes
      made->map = world::map_recording(job);
      complete(*made);
      finish([made](State& s) {
        s.results.map.made = made;
        s.view.tracks.track = 0;
        const std::size_t planes = world::planes_of_map(made->tracker()).size();
        std::string text = fmt::format("{} tracked over {}", counted(planes, "plane"),
                                       counted(made->tracker().frames().size(), "frame"));
        for (const std::string& line : made->map.told) text += "; " + line;
        say(s, text);
      });
    } catch (const Cancelled&) {
      // Whoever called it off has said so.
    } catch (const std::exception& error) {
      finish([message = message_of(error)](State& s) { say(s, message, true); });
    }
  });
}

}  // namespace planescope::desktop
