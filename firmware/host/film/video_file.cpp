// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/film/video_file.hpp"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/opt.h>
}

#include <algorithm>
#include <array>
#include <cstring>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <stdexcept>
#include <string>

namespace fovea::film {
namespace {

constexpr AVRational kTimeBase{1, 90'000};     // of the stream; what MP4 players expect
constexpr std::int64_t kUsualDuration = 3000;  // of the first frame, which has no predecessor: 1/30 s

void Check(int result, const std::string& what) {
  if (result < 0) {
    std::array<char, AV_ERROR_MAX_STRING_SIZE> words{};
    av_strerror(result, words.data(), words.size());
    throw std::runtime_error("the film cannot be written: " + what + ": " + words.data());
  }
}

struct Free {
  void operator()(AVCodecContext* c) const { avcodec_free_context(&c); }
  void operator()(AVFrame* f) const { av_frame_free(&f); }
  void operator()(AVPacket* p) const { av_packet_free(&p); }
  void operator()(AVFormatContext* f) const {
    avio_closep(&f->pb);
    avformat_free_context(f);
  }
};

}  // namespace

struct VideoFile::Impl {
  std::unique_ptr<AVFormatContext, Free> format;
  std::unique_ptr<AVCodecContext, Free> codec;
  std::unique_ptr<AVFrame, Free> frame{av_frame_alloc()};
  std::unique_ptr<AVPacket, Free> packet{av_packet_alloc()};
  AVStream* stream = nullptr;  // owned by `format`
  cv::Mat i420;                // Y, U and V planes below each other
  std::optional<std::int64_t> first_ns;
  std::int64_t given_pts = -1;  // of the last frame that the encoder got
  std::int64_t last_pts = -kUsualDuration;

  void OpenEncoder(int width_px, int height_px) {
    const AVCodec* encoder = avcodec_find_encoder_by_name("libx264");
    if (encoder == nullptr) {
      throw std::runtime_error("the film cannot be written: this libavcodec has no libx264");
    }
    codec.reset(avcodec_alloc_context3(encoder));
    codec->width = width_px;
    codec->height = height_px;
    codec->pix_fmt = AV_PIX_FMT_YUV420P;
    codec->color_range = AVCOL_RANGE_MPEG;
    codec->colorspace = AVCOL_SPC_SMPTE170M;
    codec->color_primaries = AVCOL_PRI_SMPTE170M;
    codec->color_trc = AVCOL_TRC_SMPTE170M;
    codec->time_base = kTimeBase;
    codec->gop_size = 60;
    codec->thread_count = 1;  // simulation and detection need the other cores
    if ((format->oformat->flags & AVFMT_GLOBALHEADER) != 0) {
      codec->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    }
    av_opt_set(codec->priv_data, "preset", "ultrafast", 0);
    av_opt_set(codec->priv_data, "crf", "28", 0);
    Check(avcodec_open2(codec.get(), encoder, nullptr), "libx264");
  }

  void WritePackets() {
    while (true) {
      const int result = avcodec_receive_packet(codec.get(), packet.get());
      if (result == AVERROR(EAGAIN) || result == AVERROR_EOF) {
        return;
      }
      Check(result, "encoding");
      // The film's length ends with the last frame's duration; without one, players leave that frame out.
      packet->duration = packet->pts - last_pts;
      last_pts = packet->pts;
      av_packet_rescale_ts(packet.get(), codec->time_base, stream->time_base);
      packet->stream_index = stream->index;
      Check(av_interleaved_write_frame(format.get(), packet.get()), "writing");
    }
  }
};

VideoFile::VideoFile(const std::filesystem::path& path, int width_px, int height_px)
    : impl_(std::make_unique<Impl>()) {
  av_log_set_level(AV_LOG_ERROR);
  AVFormatContext* format = nullptr;
  Check(avformat_alloc_output_context2(&format, nullptr, "mp4", path.c_str()), path.string());
  impl_->format.reset(format);
  format->flags |= AVFMT_FLAG_BITEXACT;  // no date and no version inside
  impl_->OpenEncoder(width_px, height_px);
  impl_->stream = avformat_new_stream(format, nullptr);
  impl_->stream->time_base = kTimeBase;
  Check(avcodec_parameters_from_context(impl_->stream->codecpar, impl_->codec.get()), "the stream");
  Check(avio_open(&format->pb, path.c_str(), AVIO_FLAG_WRITE), path.string());
  AVDictionary* options = nullptr;
  av_dict_set(&options, "movflags", "+faststart", 0);  // index first: the film plays while it loads
  const int result = avformat_write_header(format, &options);
  av_dict_free(&options);
  Check(result, path.string());

  impl_->frame->format = AV_PIX_FMT_YUV420P;
  impl_->frame->width = width_px;
  impl_->frame->height = height_px;
  Check(av_frame_get_buffer(impl_->frame.get(), 0), "a frame");
}

VideoFile::~VideoFile() = default;

void VideoFile::Add(const cv::Mat& bgr, std::int64_t stamp_ns) {
  AVFrame* frame = impl_->frame.get();
  Check(av_frame_make_writable(frame), "a frame");
  cv::cvtColor(bgr, impl_->i420, cv::COLOR_BGR2YUV_I420);
  const std::uint8_t* from = impl_->i420.data;
  for (std::size_t plane = 0; plane < 3; ++plane) {
    const int shift = plane == 0 ? 0 : 1;
    const auto width = static_cast<std::size_t>(frame->width >> shift);
    for (int row = 0; row < frame->height >> shift; ++row) {
      std::memcpy(frame->data[plane] + std::ptrdiff_t{row} * frame->linesize[plane], from, width);
      from += width;
    }
  }
  if (!impl_->first_ns) {
    impl_->first_ns = stamp_ns;
  }
  // Encoder and container refuse stamps that go back or are closer than the time base.
  const std::int64_t pts = av_rescale(stamp_ns - *impl_->first_ns, kTimeBase.den, 1'000'000'000);
  frame->pts = impl_->given_pts = std::max(pts, impl_->given_pts + 1);
  Check(avcodec_send_frame(impl_->codec.get(), frame), "encoding");
  impl_->WritePackets();
}

void VideoFile::Finish() {
  Check(avcodec_send_frame(impl_->codec.get(), nullptr), "encoding");
  impl_->WritePackets();
  Check(av_write_trailer(impl_->format.get()), "the index");
  Check(avio_closep(&impl_->format->pb), "closing");
}

}  // namespace fovea::film
