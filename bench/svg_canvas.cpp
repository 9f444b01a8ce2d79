// Plots as SVG.
#include "bench/plot_canvas.h"

#include <fmt/format.h>

namespace rend {

namespace {

std::string escaped(std::string_view text) {
  std::string out;
  for (char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else
      out += c;
  }
  return out;
}

}  // namespace

SvgCanvas::SvgCanvas(float width, float height)
    : out_(fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:g} {1:g}\" "
                       "width=\"{0:g}\" height=\"{1:g}\" font-family=\"system-ui, sans-serif\">\n",
                       width, height)) {}

void SvgCanvas::line(const std::vector<PlotXY>& points, std::uint32_t color, float width,
                     bool dashed) {
  out_ += "<polyline points=\"";
  for (const PlotXY& p : points) out_ += fmt::format("{:.1f},{:.1f} ", p[0], p[1]);
  out_ += fmt::format(
      "\" fill=\"none\" stroke=\"#{:06x}\" stroke-width=\"{:g}\" stroke-linecap=\"round\" "
      "stroke-linejoin=\"round\"{}/>\n",
      color, width, dashed ? " stroke-dasharray=\"6 5\"" : "");
}

void SvgCanvas::circle(PlotXY centre, float radius, std::uint32_t color, float width) {
  out_ +=
      fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:g}\" ", centre[0], centre[1], radius);
  if (width > 0)
    out_ += fmt::format("fill=\"#fff\" stroke=\"#{:06x}\" stroke-width=\"{:g}\"/>\n", color, width);
  else
    out_ += fmt::format("fill=\"#{:06x}\"/>\n", color);
}

void SvgCanvas::rectangle(PlotXY low, PlotXY size, std::uint32_t color) {
  out_ += fmt::format(
      "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"#{:06x}\"/>\n",
      low[0], low[1], size[0], size[1], color);
}

void SvgCanvas::text(PlotXY at, std::string_view text, float height, std::uint32_t color,
                     Anchor anchor) {
  const char* anchors[] = {"start", "middle", "end"};
  // Capitals are about 0.72 of the size of common fonts.
  out_ += fmt::format(
      "<text x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"{:.1f}\" fill=\"#{:06x}\" "
      "text-anchor=\"{}\">{}</text>\n",
      at[0], at[1], height / 0.72f, color, anchors[static_cast<int>(anchor)], escaped(text));
}

}  // namespace rend
