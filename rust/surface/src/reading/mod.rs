//! Signed distances of posed skin, through thin walls and sheets as well.

pub(crate) mod facing;
pub(crate) mod opposing_wall;
pub(crate) mod neighborhood;
pub(crate) mod flesh;
pub(crate) mod sheet_side;
pub(crate) mod tool_end;
pub(crate) mod unread_points;
pub(crate) mod through_walls;
pub(crate) mod skin_queries;
pub(crate) mod kept_readings;
