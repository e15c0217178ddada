#ifndef PLUMBLINE_APPS_PICTURES_PICTURE_LAYOUT_H_
#define PLUMBLINE_APPS_PICTURES_PICTURE_LAYOUT_H_

namespace plumbline {

// Sizes that all pictures of maps share.
inline constexpr int kTitlePx = 44;   ///< strip of a title
inline constexpr int kFooterPx = 56;  ///< strip of the scale bar
inline constexpr int kBorderPx = 20;  ///< left and right of a map
inline constexpr double kFontPx = 18.0;

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_PICTURES_PICTURE_LAYOUT_H_
