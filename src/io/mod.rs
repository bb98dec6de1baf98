//! Files: geometry in the formats of other programs, point pairs, folders of pairs, the VGG layout,
//! and atomic output.

#[cfg(feature = "inspector")]
mod autosave;
mod calibration;
mod camera_rig;
#[cfg(feature = "colmap")]
mod colmap;
mod covariance;
mod exif;
#[cfg(feature = "inspector")]
mod figure;
mod geometry_file;
mod ground_truth;
mod hash;
mod identity;
#[cfg(feature = "inspector")]
mod import_source;
#[cfg(feature = "inspector")]
mod importing;
mod match_file;
mod npy;
mod number;
mod output;
mod pair_folder;
mod part_file;
#[cfg(feature = "inspector")]
mod pasted_table;
mod picture_file;
#[cfg(feature = "inspector")]
mod picture_folder;
mod ply;
mod point_pairs;
mod point_result;
mod read;
mod rectified;
#[cfg(feature = "inspector")]
mod report;
mod result_file;
mod result_words;
mod sequence_file;
mod session;
mod stereo_pair;
#[cfg(feature = "inspector")]
mod tables;
mod truth_folder;
mod undistorted;
mod values;
mod vgg;

pub use calibration::{CalibratedCamera, Calibration, CameraPose, CameraReading};
#[doc(hidden)]
pub use camera_rig::CameraRig;
#[cfg(feature = "colmap")]
pub use colmap::{ColmapError, ColmapPair};
pub use exif::focal_length_from_exif;
pub use geometry_file::{
    CalibratedNote, Format, GeometryFile, ImageNote, Notation, PairLabel, PairOrigin, TrustNote,
    read_fundamental, read_point_pairs,
};
#[doc(hidden)]
pub use ground_truth::{GroundTruth, TruthError, TruthOrigin};
#[doc(hidden)]
pub use identity::refuse_clashes;
pub use match_file::{MatchFile, read_matches};
pub use npy::fundamental_as_npy;
#[doc(hidden)]
pub use output::OutputFile;
pub use output::WriteError;
#[doc(hidden)]
pub use pair_folder::{PairFiles, pair_folder};
pub use picture_file::{PictureError, PictureFormat};
#[doc(hidden)]
pub use picture_file::{described, encode_picture};
pub use ply::cloud_as_ply;
pub use point_pairs::parse_point_pairs;
pub use point_result::{PointResultFile, points_in_words};
pub use read::{IMAGE_EXTENSIONS, Problem, ReadError, has_extension, has_image_extension};
pub use rectified::{RectifiedError, RectifiedFiles, RectifiedOptions};
pub use result_file::ResultFile;
pub use result_words::result_in_words;
pub use sequence_file::{
    MOST_FRAMES, SequenceError, SequenceFile, VIDEO_EXTENSIONS, is_sequence, read_sequence,
};
#[doc(hidden)]
pub use session::{
    HandOverError, ImageReference, ImageSource, Located, SESSION_VERSION, SessionError, SessionFile,
    relative, resolve, sha256_of,
};
pub use stereo_pair::{StereoPair, StereoPairFiles, StereoProgram};
#[doc(hidden)]
pub use truth_folder::TruthFolder;
pub use undistorted::UndistortedFiles;
#[doc(hidden)]
pub use vgg::VggFolder;
pub use vgg::read_camera;

/// Files of the window.
#[cfg(feature = "inspector")]
#[doc(hidden)]
pub use self::{
    autosave::Autosave,
    figure::{
        Figure, FigureArea, FigureColor, FigureFont, FigurePicture, FigureShape, FigureStroke, write_pdf,
        write_svg,
    },
    import_source::{ImportSource, is_importable, sources},
    importing::{Import, ImportFound, ImportedFile, ImportedMatrix},
    pasted_table::parse_table,
    picture_folder::PictureFolder,
    report::report_in_words,
    tables::{LINE_COLUMNS, PairRow, barcode_table, line_table, pair_table},
};
