// The page's own HTML, CSS and JavaScript: stage.html, plan_page.css and plan_page.js as texts of the program.
#pragma once

namespace fjr {

extern const char* const kStage;  // opens a <div> that the plots follow in
extern const char* const kPlanPageStyle;
extern const char* const kPlanPageScript;

}  // namespace fjr
