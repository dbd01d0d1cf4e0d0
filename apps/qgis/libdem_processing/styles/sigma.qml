<!DOCTYPE qgis PUBLIC 'http://mrcc.com/qgis.dtd' 'SYSTEM'>
<qgis version="3.22" styleCategories="Symbology">
  <pipe>
    <rasterrenderer type="singlebandpseudocolor" band="1" opacity="1" alphaBand="-1" nodataColor="" classificationMin="0" classificationMax="50">
      <rastershader>
        <colorrampshader colorRampType="INTERPOLATED" classificationMode="1" clip="0" minimumValue="0" maximumValue="50" labelPrecision="0">
          <item value="0" color="#440154" alpha="0" label="0 m: measured"/>
          <item value="0.5" color="#46327e" alpha="255" label="0.5 m"/>
          <item value="2" color="#365c8d" alpha="255" label="2 m"/>
          <item value="5" color="#277f8e" alpha="255" label="5 m"/>
          <item value="10" color="#1fa187" alpha="255" label="10 m"/>
          <item value="20" color="#4ac16d" alpha="255" label="20 m"/>
          <item value="30" color="#a0da39" alpha="255" label="30 m"/>
          <item value="50" color="#fde725" alpha="255" label="50 m and more"/>
        </colorrampshader>
      </rastershader>
    </rasterrenderer>
    <brightnesscontrast brightness="0" contrast="0" gamma="1"/>
    <huesaturation saturation="0" colorizeOn="0" grayscaleMode="0"/>
    <rasterresampler maxOversampling="2"/>
  </pipe>
  <blendMode>0</blendMode>
</qgis>
