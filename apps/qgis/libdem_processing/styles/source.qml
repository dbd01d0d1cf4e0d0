<!DOCTYPE qgis PUBLIC 'http://mrcc.com/qgis.dtd' 'SYSTEM'>
<qgis version="3.22" styleCategories="Symbology">
  <pipe>
    <rasterrenderer type="paletted" band="1" opacity="1" alphaBand="-1" nodataColor="">
      <colorPalette>
        <paletteEntry value="0" color="#a0a0a0" alpha="0" label="measured"/>
        <paletteEntry value="1" color="#e6781e" alpha="255" label="filled by method"/>
        <paletteEntry value="2" color="#5aa03c" alpha="255" label="filled over an auxiliary DEM"/>
        <paletteEntry value="3" color="#326ec8" alpha="255" label="water, flat"/>
        <paletteEntry value="4" color="#000000" alpha="255" label="left void"/>
      </colorPalette>
    </rasterrenderer>
    <brightnesscontrast brightness="0" contrast="0" gamma="1"/>
    <huesaturation saturation="0" colorizeOn="0" grayscaleMode="0"/>
    <rasterresampler maxOversampling="2"/>
  </pipe>
  <blendMode>0</blendMode>
</qgis>
